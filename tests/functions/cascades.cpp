#include "uber/reference/cascades.h"

#include "tests/functions/cascade_maps.h"

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

    const DepthTexture texture = blocks(32);
    cascades.texture("sampler2DArrayShadow maps", texture.image(true), nearest(true));
    const auto compare = [&texture](int layer, auto uv, auto depth) { return texture.compare(uv, depth, layer); };
    cascades.test(
        "cascade_factor(maps, vec4(x, y, z, w), layer, 1e-4)",
        [compare](auto x, auto y, auto z, auto w, int layer) {
            using T = decltype(x);
            return cascade_factor(compare, Vec4<T>{x, y, z, w}, layer, T(1e-4));
        },
        number("x", linear(-2, 2)), number("y", linear(-2, 2)), number("z", linear(-0.5, 2)),
        number("w", linear(-0.5, 2).also({0})), integer("layer", 0, 3));
    cascades.texture("sampler2DArray depths", texture.image(true, false), nearest(false));
    const auto factor = [compare](auto x, auto y, auto z, auto w, int layer) {
        using T = decltype(x);
        return cascade_factor(compare, Vec4<T>{x, y, z, w}, layer, T(1e-4));
    };
    cascades.test("cascade_factor_gathered(maps, vec4(x, y, z, w), layer, 1e-4)", factor, number("x", linear(-2, 2)),
                  number("y", linear(-2, 2)), number("z", linear(-0.5, 2)), number("w", linear(-0.5, 2).also({0})),
                  integer("layer", 0, 3));
    cascades.test("cascade_factor_fetched(depths, vec4(x, y, z, w), layer, 1e-4)", factor, number("x", linear(-2, 2)),
                  number("y", linear(-2, 2)), number("z", linear(-0.5, 2)), number("w", linear(-0.5, 2).also({0})),
                  integer("layer", 0, 3));
    cascades.test(
        "cascade_factor_gathered_linear(maps, vec4(x, y, z, w), layer, 1e-4)",
        [&texture](auto x, auto y, auto z, auto w, int layer) {
            using T = decltype(x);
            const auto texel = [&texture](int of, int i, int j, const T& depth) {
                const int last = texture.size - 1;
                const size_t at =
                    static_cast<size_t>((of * texture.size + std::clamp(j, 0, last)) * texture.size + std::clamp(i, 0, last));
                return depth <= T(static_cast<double>(texture.depths[at])) ? T(1) : T(0);
            };
            return cascade_factor_gathered_linear(texel, texture.size, Vec4<T>{x, y, z, w}, layer, T(1e-4));
        },
        number("x", linear(-2, 2)), number("y", linear(-2, 2)), number("z", linear(-0.5, 2)),
        number("w", linear(-0.5, 2).also({0})), integer("layer", 0, 3));
    cascades
        .test(
            "cascaded_shadow(maps, vec4(at, 1.0), vec4(next, 1.0), vec2(1e-4, 2e-4), choose_cascade(depth, 0.1, vec4(10.0, 20.0, "
            "30.0, 40.0), 4, 0.2))",
            [compare](auto at, auto next, auto depth) {
                using T = decltype(depth);
                const CascadeChoice<T> choice = choose_cascade(depth, T(0.1), Vec4<T>{T(10), T(20), T(30), T(40)}, 4, T(0.2));
                return cascaded_shadow(compare, Vec4<T>{at.x, at.y, at.z, T(1)}, Vec4<T>{next.x, next.y, next.z, T(1)},
                                       Vec2<T>{T(1e-4), T(2e-4)}, choice);
            },
            vector3("at", linear(-1.2, 1.2)), vector3("next", linear(-1.2, 1.2)),
            number("depth", linear(0, 42).also({10, 20, 30, 40})))
        .named("cascaded_shadow");
    cascades.run();
}

}  // namespace
}  // namespace kiln::test
