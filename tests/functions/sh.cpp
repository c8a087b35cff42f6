#include "uber/reference/sh.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

const Range coefficients = either_sign(1e-3, 1e3);

TEST(Functions, Sh) {
    Functions sh("sh.glsl", "lecture_sh.glsl");
    sh.test(
        "sh_l1_basis(p)", [](auto p) { return sh_l1_basis(p); }, unit("p"));
    sh.test(
        "sh_band2_basis(p)", [](auto p) { return sh_band2_basis(p); }, unit("p"));
    sh.test(
        "sh_band2_basis_last(p)", [](auto p) { return sh_band2_basis_last(p); }, unit("p"));

    sh.test(
          "ShMomentsL1 s = sh_moments_accumulate(sh_moments_zero(), d, l, sr); result = vec3[4](s.m0, s.m1_y, s.m1_z, s.m1_x);",
          [](auto d, auto l, auto sr) {
              using T = decltype(sr);
              const ShMomentsL1<T> s = sh_moments_accumulate(ShMomentsL1<T>{}, d, l, sr);
              return std::array<Vec3<T>, 4>{s.m0, s.m1_y, s.m1_z, s.m1_x};
          },
          unit("d"), vector3("l", linear(0, 100)), number("sr", logarithmic(1e-6, 12)))
        .named("sh_moments_accumulate");
    sh.test(
          "ShL1 s = sh_l1_accumulate(sh_l1_zero(), d, l, sr); result = s.c;",
          [](auto d, auto l, auto sr) { return sh_l1_accumulate(ShL1<decltype(sr)>{}, d, l, sr).c; }, unit("d"),
          vector3("l", linear(0, 100)), number("sr", logarithmic(1e-6, 12)))
        .named("sh_l1_accumulate");
    sh.test(
          "ShL2 s = sh_l2_accumulate(sh_l2_zero(), d, l, sr); result = s.c;",
          [](auto d, auto l, auto sr) { return sh_l2_accumulate(ShL2<decltype(sr)>{}, d, l, sr).c; }, unit("d"),
          vector3("l", linear(0, 100)), number("sr", logarithmic(1e-6, 12)))
        .named("sh_l2_accumulate");

    sh.test(
          "ShMomentsL1 s = sh_moments_of(ShL1(c)); result = vec3[4](s.m0, s.m1_y, s.m1_z, s.m1_x);",
          [](auto c) {
              const auto s = sh_moments_of(ShL1<decltype(c[0].x)>{c});
              return std::array{s.m0, s.m1_y, s.m1_z, s.m1_x};
          },
          array<4>(vector3("c", coefficients)))
        .named("sh_moments_of");
    sh.test(
          "result = sh_l1_of(ShMomentsL1(m[0], m[1], m[2], m[3])).c;",
          [](auto m) {
              return sh_l1_of(ShMomentsL1<decltype(m[0].x)>{m[0], m[1], m[2], m[3]}).c;
          },
          array<4>(vector3("m", coefficients)))
        .named("sh_l1_of");
    sh.test(
          "result = sh_l1_convolve(ShL1(c)).e;", [](auto c) { return sh_l1_convolve(ShL1<decltype(c[0].x)>{c}).e; },
          array<4>(vector3("c", coefficients)))
        .named("sh_l1_convolve");
    sh.test(
          "result = sh_l2_convolve(ShL2(c)).e;", [](auto c) { return sh_l2_convolve(ShL2<decltype(c[0].x)>{c}).e; },
          array<9>(vector3("c", coefficients)))
        .named("sh_l2_convolve");
    sh.test(
          "ShWeightedL1 s = sh_l1_weight(ShMomentsL1(m[0], m[1], m[2], m[3])); result = vec3[4](s.w0, s.w1_y, s.w1_z, s.w1_x);",
          [](auto m) {
              const auto s = sh_l1_weight(ShMomentsL1<decltype(m[0].x)>{m[0], m[1], m[2], m[3]});
              return std::array{s.w0, s.w1_y, s.w1_z, s.w1_x};
          },
          array<4>(vector3("m", coefficients)))
        .named("sh_l1_weight");
    sh.run();
}

TEST(Functions, ShEvaluation) {
    Functions sh("sh.glsl", "lecture_sh.glsl");
    sh.test(
          "result = sh_l2_radiance(ShL2(c), p);", [](auto c, auto p) { return sh_l2_radiance(ShL2<decltype(p.x)>{c}, p); },
          array<9>(vector3("c", coefficients)), unit("p"))
        .named("sh_l2_radiance");
    sh.test(
          "result = sh_irradiance_convolved(sh_l1_convolve(ShL1(c)), n);",
          [](auto c, auto n) { return sh_irradiance_convolved(sh_l1_convolve(ShL1<decltype(n.x)>{c}), n); },
          array<4>(vector3("c", coefficients)), unit("n"))
        .named("sh_irradiance_convolved.l1");
    sh.test(
          "result = sh_irradiance_convolved(sh_l2_convolve(ShL2(c)), n);",
          [](auto c, auto n) { return sh_irradiance_convolved(sh_l2_convolve(ShL2<decltype(n.x)>{c}), n); },
          array<9>(vector3("c", coefficients)), unit("n"))
        .named("sh_irradiance_convolved.l2");
    sh.test(
          "result = sh_irradiance_from_radiance(ShL1(c), n);",
          [](auto c, auto n) { return sh_irradiance_from_radiance(ShL1<decltype(n.x)>{c}, n); },
          array<4>(vector3("c", coefficients)), unit("n"))
        .named("sh_irradiance_from_radiance.l1");
    sh.test(
          "result = sh_irradiance_from_radiance(ShL2(c), n);",
          [](auto c, auto n) { return sh_irradiance_from_radiance(ShL2<decltype(n.x)>{c}, n); },
          array<9>(vector3("c", coefficients)), unit("n"))
        .named("sh_irradiance_from_radiance.l2");
    sh.test(
          "result = sh_irradiance_from_moments(ShMomentsL1(m[0], m[1], m[2], m[3]), n);",
          [](auto m, auto n) {
              return sh_irradiance_from_moments(ShMomentsL1<decltype(n.x)>{m[0], m[1], m[2], m[3]}, n);
          },
          array<4>(vector3("m", coefficients)), unit("n"))
        .named("sh_irradiance_from_moments");
    sh.test(
          "result = sh_irradiance_from_weighted(ShWeightedL1(m[0], m[1], m[2], m[3]), n);",
          [](auto m, auto n) {
              return sh_irradiance_from_weighted(ShWeightedL1<decltype(n.x)>{m[0], m[1], m[2], m[3]}, n);
          },
          array<4>(vector3("m", coefficients)), unit("n"))
        .named("sh_irradiance_from_weighted");
    sh.test(
          "result = sh_irradiance_clamped(ShMomentsL1(m[0], m[1], m[2], m[3]), n);",
          [](auto m, auto n) {
              return sh_irradiance_clamped(ShMomentsL1<decltype(n.x)>{m[0], m[1], m[2], m[3]}, n);
          },
          array<4>(vector3("m", coefficients)), unit("n"))
        .named("sh_irradiance_clamped.l1");
    sh.test(
          "result = sh_irradiance_clamped(ShL2(c), n);",
          [](auto c, auto n) { return sh_irradiance_clamped(ShL2<decltype(n.x)>{c}, n); }, array<9>(vector3("c", coefficients)),
          unit("n"))
        .named("sh_irradiance_clamped.l2");
    // The matrix and the sum are one polynomial, up to x^2 + y^2 + z^2 = 1, which rounded vectors miss by 2e-7.
    sh.test(
          "ShL2 s; for (int i = 0; i < 9; ++i) s.c[i] = vec3(c[i], 2.0 * c[i], -c[i]); result = "
          "sh_quadratic_irradiance(sh_quadratic(s), n);",
          [](auto c, auto n) {
              using T = decltype(n.x);
              const T e = sh_quadratic_irradiance(sh_quadratic_matrix(c), n);
              return Vec3<T>{e, e * T(2), -e};
          },
          array<9>(number("c", coefficients)), unit("n"))
        .named("sh_quadratic_irradiance");
    // m1 may be longer than m0, which no light is; q^p near q = 0 is where log2 has the fewest digits.
    sh.test(
        "sh_irradiance_nonlinear_channel(m0, m1, n)",
        [](auto m0, auto m1, auto n) { return sh_irradiance_nonlinear_channel(m0, m1, n); },
        number("m0", logarithmic(1e-3, 1e3).also({0.0, -1.0})), vector3("m1", either_sign(1e-4, 1e3)), unit("n"));
    sh.test(
        "sh_zh3_zonal(k, z)", [](auto k, auto z) { return sh_zh3_zonal(k, z); }, number("k", linear(0, 1)),
        number("z", linear(-1, 1)));
    sh.test(
        "sh_irradiance_zh3_channel(m0, m1, n)", [](auto m0, auto m1, auto n) { return sh_irradiance_zh3_channel(m0, m1, n); },
        number("m0", logarithmic(1e-3, 1e3).also({0.0, -1.0})), vector3("m1", either_sign(1e-4, 1e3)), unit("n"));
    // Three channels whose moments all but cancel in luminance have an axis that rounding decides.
    sh.test(
          "result = sh_irradiance_zh3_luminance(ShMomentsL1(m0, m1[0], m1[1], m1[2]), n);",
          [](auto m0, auto m1, auto n) {
              return sh_irradiance_zh3_luminance(ShMomentsL1<decltype(n.x)>{m0, m1[0], m1[1], m1[2]}, n);
          },
          vector3("m0", logarithmic(1e-3, 1e3).also({0.0, -1.0})), array<3>(vector3("m1", either_sign(1e-2, 1e3))), unit("n"))
        .named("sh_irradiance_zh3_luminance");
    sh.test(
        "sh_irradiance_lecture(c, n)", [](auto c, auto n) { return sh_irradiance_lecture(c, n); }, vector4("c", coefficients),
        unit("n"));
    sh.run();
}

}  // namespace
}  // namespace kiln::test
