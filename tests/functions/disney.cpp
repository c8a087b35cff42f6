#include "uber/reference/disney.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Disney) {
    Functions disney("disney.glsl");
    const auto l = number("l", linear(0, 1)), v = number("v", linear(1e-4, 1)), lh = number("lh", linear(0, 1));
    const auto roughness = number("roughness", linear(0, 1)), any = number("x", linear(-0.5, 1.5).also({0, 1}));
    disney.test(
        "schlick_weight(x)", [](auto x) { return schlick_weight(x); }, any);
    disney.test(
        "disney_diffuse(l, v, lh, roughness)", [](auto a, auto b, auto c, auto r) { return disney_diffuse(a, b, c, r); }, l, v,
        lh, roughness);
    disney.test(
        "disney_diffuse_renormalised(l, v, lh, roughness)",
        [](auto a, auto b, auto c, auto r) { return disney_diffuse_renormalised(a, b, c, r); }, l, v, lh, roughness);
    disney.test(
        "disney_subsurface(l, v, lh, roughness)", [](auto a, auto b, auto c, auto r) { return disney_subsurface(a, b, c, r); }, l,
        v, lh, roughness);
    disney.test(
        "disney_tint(base)", [](auto base) { return disney_tint(base); }, colour("base"));
    disney
        .test(
            "vec2(disney_alpha(x), disney_masking_alpha(x))",
            [](auto x) {
                return Vec2<decltype(x)>{disney_alpha(x), disney_masking_alpha(x)};
            },
            any)
        .named("disney_alphas");
    disney
        .test(
            "disney_specular(n, h, l, v, lh, f0, roughness)",
            [](auto n, auto h, auto a, auto b, auto c, auto f0, auto r) { return disney_specular(n, h, a, b, c, f0, r); },
            unit("n"), near("h", "n", 1), l, v, lh, colour("f0"), roughness)
        .skip([](auto n, auto h, double, double, double, auto, double) { return dot(n, h) < 0; });
    disney
        .test(
            "disney_clearcoat(n, h, l, v, lh, gloss)",
            [](auto n, auto h, auto a, auto b, auto c, auto g) { return disney_clearcoat(n, h, a, b, c, g); }, unit("n"),
            near("h", "n", 1), l, v, lh, number("gloss", linear(-0.2, 1.2).also({0, 1})))
        .skip([](auto n, auto h, double, double, double, double) { return dot(n, h) < 0; });
    // All of it, with parameters beyond [0, 1] too.
    disney.declare(
        "vec3 whole(vec3 n, vec3 v, vec3 l, vec3 base, vec4 p, vec4 q, float r) {"
        " return disney_brdf(n, v, l, DisneyMaterial(base, p.x, p.y, p.z, r, p.w, q.x, q.y, q.z, q.w)); }");
    disney
        .test(
            "whole(n, v, l, base, p, q, roughness)",
            [](auto n, auto view, auto light, auto base, auto p, auto q, auto r) {
                using T = decltype(r);
                return disney_brdf(n, view, light, DisneyMaterial<T>{base, p.x, p.y, p.z, r, p.w, q.x, q.y, q.z, q.w});
            },
            unit("n"), hemisphere("v", "n"), unit("l"), colour("base"), vector4("p", linear(-0.2, 1.2)),
            vector4("q", linear(-0.2, 1.2)), roughness)
        .named("disney_brdf");
    disney.run();
}

}  // namespace
}  // namespace kiln::test
