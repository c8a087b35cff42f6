#include "uber/reference/ibl.h"

#include "tests/functions/function.h"
#include "uber/reference/ibl_bake.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Ibl) {
    Functions ibl("ibl.glsl");
    ibl.test(
        "split_sum_uv(n_dot_v, roughness, size)",
        [](auto n_dot_v, auto roughness, auto size) { return split_sum_uv(n_dot_v, roughness, size); },
        number("n_dot_v", linear(-0.5, 1.5)), number("roughness", linear(-0.5, 1.5)), number("size", linear(2, 256)));
    ibl.test(
        "split_sum_fit(n_dot_v, roughness)", [](auto n_dot_v, auto roughness) { return split_sum_fit(n_dot_v, roughness); },
        number("n_dot_v", linear(-0.5, 1.5)), number("roughness", linear(-0.5, 1.5)));
    ibl.test(
        "environment_specular(l, f0, ab)", [](auto l, auto f0, auto ab) { return environment_specular(l, f0, ab); },
        vector3("l", linear(0, 100)), colour("f0"), vector2("ab", linear(0, 1)));
    ibl.test(
        "environment_specular_multiscatter(l, f0, ab)",
        [](auto l, auto f0, auto ab) { return environment_specular_multiscatter(l, f0, ab); }, vector3("l", linear(0, 100)),
        colour("f0"), vector2("ab", linear(0, 1)));
    ibl.test(
           "image_based_light(c, f0, e, l, ab)",
           [](auto c, auto f0, auto e, auto l, auto ab) { return image_based_light(c, f0, e, l, ab); }, colour("c"), colour("f0"),
           vector3("e", linear(0, 100)), vector3("l", linear(0, 100)), vector2("ab", linear(0, 1)))
        .skip([](auto, auto, auto, auto, auto ab) { return ab.x + ab.y > 1 || ab.x + ab.y < 0.1; });
    ibl.run();
}

TEST(Functions, IblBake) {
    Functions bake("ibl_bake.glsl");
    bake.test(
            "radical_inverse(i) * scale",
            [](auto i, auto scale) { return decltype(scale)(radical_inverse(static_cast<uint32_t>(i))) * scale; }, bits("i"),
            number("scale", values({1, 2})))
        .named("radical_inverse");
    bake.test(
        "frame_around(n)", [](auto n) { return frame_around(n); }, unit("n"));
    bake.test(
        "sample_cosine(u)", [](auto u) { return sample_cosine(u); }, vector2("u", linear(0, 1)));
    bake.test(
        "sample_ggx_half(u, alpha)", [](auto u, auto alpha) { return sample_ggx_half(u, alpha); }, vector2("u", linear(0, 1)),
        number("alpha", logarithmic(0.002, 1)));
    bake.test(
        "filtered_lod(pdf, count, size)", [](auto pdf, auto count, auto size) { return filtered_lod(pdf, count, size); },
        number("pdf", logarithmic(1e-4, 1e5)), number("count", logarithmic(1, 65536)), number("size", logarithmic(1, 4096)));
    bake.run();
}

}  // namespace
}  // namespace kiln::test
