#include "uber/reference/lecture_brdf.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

// Where the lecture's forms are usable the device computes what they say.
TEST(Functions, LectureBrdf) {
    Functions lecture("lecture_brdf.glsl");
    const auto cosine = linear(0.01, 1), unit_range = linear(0, 1);
    lecture.test(
        "ggx_distribution_lecture(c, r)", [](auto c, auto r) { return ggx_distribution_lecture(c, r); },
        number("c", linear(0, 1)), number("r", linear(0.05, 1)));
    lecture.test(
        "smith_lecture(v, l, r)", [](auto v, auto l, auto r) { return smith_lecture(v, l, r); }, number("v", unit_range),
        number("l", unit_range), number("r", unit_range));
    lecture.test(
        "fresnel_schlick_lecture(c, f0)", [](auto c, auto f0) { return fresnel_schlick_lecture(c, f0); }, number("c", unit_range),
        number("f0", unit_range));
    lecture.test(
        "specular_lecture(l, v, h, vh, f0, r)",
        [](auto l, auto v, auto h, auto vh, auto f0, auto r) { return specular_lecture(l, v, h, vh, f0, r); },
        number("l", unit_range), number("v", unit_range), number("h", unit_range), number("vh", cosine), colour("f0"),
        number("r", linear(0.1, 1)));
    lecture
        .test(
            "cook_torrance_lecture(SpecularGlossiness(f0, kd, n, gloss), v, l, 0.5)",
            [](auto n, auto v, auto l, auto f0, auto kd, auto gloss) {
                using T = decltype(gloss);
                return cook_torrance_lecture(SpecularGlossiness<T>{f0, kd, n, gloss}, v, l, T(0.5));
            },
            unit("n"), hemisphere("v", "n"), hemisphere("l", "n"), colour("f0"), colour("kd"), number("gloss", linear(0, 0.9)))
        // v and l opposite: see below; and 1 - v.h within rounding of 0, whose pow has no bound.
        .skip([](auto, auto v, auto l, auto, auto, double) { return length(v + l) < 1e-2 || length(v - l) < 1e-2; })
        .named("cook_torrance_lecture");
    lecture
        .test(
            "SpecularGlossiness s = metallic_to_specular_lecture(MetallicRoughness(base, vec3(0.0), r, m), d);"
            " result = mat3(s.specular, s.diffuse, vec3(s.glossiness));",
            [](auto base, auto r, auto m, auto d) {
                using T = decltype(r);
                const auto s = metallic_to_specular_lecture(MetallicRoughness<T>{base, splat3(T(0)), r, m}, d);
                return Mat3<T>{{s.specular, s.diffuse, splat3(s.glossiness)}};
            },
            colour("base"), number("r", linear(-1, 2)), number("m", linear(-1, 2)), number("d", unit_range))
        .named("metallic_to_specular_lecture");
    lecture
        .test(
            "blinn_phong_lecture(n, v, l, kd, ks, p)",
            [](auto n, auto v, auto l, auto kd, auto ks, auto p) { return blinn_phong_lecture(n, v, l, kd, ks, p); }, unit("n"),
            hemisphere("v", "n"), unit("l"), colour("kd"), colour("ks"), number("p", linear(1, 100)))
        .skip([](auto, auto v, auto l, auto, auto, double) { return length(v + l) < 1e-2; });
    lecture.run();
}

// Where they fail, they fail as predicted: 1 for each failure.
TEST(Functions, LectureBrdfFails) {
    Functions lecture("lecture_brdf.glsl");
    const auto one = [](auto x) { return decltype(x)(1); };
    // alpha^2 - 1 rounds to -1, and f is 0: exact are 3e9 to 1e7.
    lecture.test("isinf(ggx_distribution_lecture(1.0, alpha)) ? 1.0 : 0.0", one, number("alpha", logarithmic(1e-5, 1.7e-4)))
        .named("ggx_distribution_lecture_infinite");
    lecture.test("isnan(ggx_distribution_lecture(1.0, alpha)) ? 1.0 : 0.0", one, number("alpha", values({0})))
        .named("ggx_distribution_lecture_nan");
    // 30 %, 45 %, 110 % of 1 / (pi alpha^2).
    lecture
        .test(
            "abs(ggx_distribution_lecture(1.0, alpha) * pi * alpha * alpha - x) < 0.01 ? 1.0 : 0.0",
            [](auto, auto x) { return decltype(x)(1); }, number("alpha", values({1.8e-4})), number("x", values({0.2956})))
        .named("ggx_distribution_lecture_at_1.8e-4");
    lecture
        .test(
            "abs(ggx_distribution_lecture(1.0, alpha) * pi * alpha * alpha - x) < 0.01 ? 1.0 : 0.0",
            [](auto, auto x) { return decltype(x)(1); }, number("alpha", values({5e-4})), number("x", values({1.0994})))
        .named("ggx_distribution_lecture_at_5e-4");
    // v.h an ulp above 1: pow of a negative number.
    lecture.test("isnan(fresnel_schlick_lecture(c, 0.04)) ? 1.0 : 0.0", one, number("c", values({1.00000012, 1.0000002})))
        .named("fresnel_schlick_lecture_nan");
    // Opposite directions have no half vector.
    lecture
        .test(
            "isnan(normalize(v - v).x) ? 1.0 : 0.0", [](auto v) { return decltype(v.x)(1); }, unit("v"))
        .named("half_vector_lecture_nan");
    // The padded denominator at n.l = n.v = 0 gives 0, where the limit is finite.
    lecture
        .test(
            "specular_lecture(c, c, 1.0, 1.0, vec3(1.0), 0.5)", [](auto c) { return splat3(c); }, number("c", values({0})))
        .named("specular_lecture_at_grazing");
    // The highlight from behind.
    lecture
        .test(
            "blinn_phong_lecture(vec3(0.0, 0.0, 1.0), vec3(0.6, 0.0, 0.8), vec3(-0.8, 0.0, z), vec3(0.0), vec3(1.0), 1.0).x > 0.2"
            " ? 1.0 : 0.0",
            one, number("z", values({-0.6})))
        .named("blinn_phong_lecture_leak");
    lecture.run();
}

}  // namespace
}  // namespace kiln::test
