#include "uber/reference/cascades.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Cascades) {
    Functions cascades("cascades.glsl");
    // Row 27: the ends themselves and the floats beside them are among the samples, so that each has exactly the slice that the
    // half-open intervals give it.
    const double ends[] = {6.690505994, 14.884208245, 32.093345575, 100};
    const auto view_depth = [&] { return number("depth", linear(-1, 110).also({0, 0.1, ends[0], ends[1], ends[2], ends[3]})); };
    const std::string splits = "vec4(6.690505994, 14.884208245, 32.093345575, 100.0)";
    const auto float_ends = [ends](auto x) {
        using T = decltype(x);
        const auto rounded = [](double e) { return T(static_cast<double>(static_cast<float>(e))); };
        return Vec4<T>{rounded(ends[0]), rounded(ends[1]), rounded(ends[2]), rounded(ends[3])};
    };
    cascades
        .test(
            "result = float(cascade_index(depth, " + splits + ", count));",
            [float_ends](auto depth, int count) {
                using T = decltype(depth);
                return T(cascade_index(depth, float_ends(depth), count));
            },
            view_depth(), integer("count", 1, 4))
        .named("cascade_index")
        .undecided(0);
    cascades.test(
        "cascade_blend(depth, start, start + size, band)",
        [](auto depth, auto start, auto size, auto band) { return cascade_blend(depth, start, start + size, band); },
        number("depth", linear(0, 120)), number("start", linear(0, 100)), number("size", logarithmic(0.5, 100)),
        number("band", linear(0.05, 1)));
    // No band: a step, and nothing that is not a number.
    cascades
        .test(
            "cascade_blend(depth, 10.0, 20.0, 0.0)",
            [](auto depth) {
                using T = decltype(depth);
                return cascade_blend(depth, T(10), T(20), T(0));
            },
            number("depth", linear(0, 40).also({20})))
        .named("cascade_blend_without_a_band");
    cascades
        .test(
            "CascadeChoice c = choose_cascade(depth, 0.1, " + splits +
                ", count, 0.1); result = vec3(float(c.index), float(c.next), c.blend);",
            [float_ends](auto depth, int count) {
                using T = decltype(depth);
                const CascadeChoice<T> c = choose_cascade(depth, T(0.1), float_ends(depth), count, T(0.1));
                return Vec3<T>{T(c.index), T(c.next), c.blend};
            },
            view_depth(), integer("count", 1, 4))
        .named("choose_cascade");
    cascades.run();
}

}  // namespace
}  // namespace kiln::test
