#include "uber/reference/smith.h"

#include "tests/functions/function.h"
#include "uber/reference/ggx.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Smith) {
    Functions smith("smith.glsl");
    const auto l = number("l", logarithmic(1e-4, 1)), v = number("v", logarithmic(1e-4, 1));
    const auto alpha = number("alpha", logarithmic(0.002, 1)), pushed = number("alpha", logarithmic(0.002, 16));
    smith.test(
        "smith_root(c, alpha)", [](auto c, auto a) { return smith_root(c, a); }, number("c", linear(0, 1)), pushed);
    // The textbook difference in long double loses 1e-19 / q of itself, q = (alpha tan)^2.
    smith
        .test(
            "smith_lambda(c, alpha)", [](auto c, auto a) { return smith_lambda(c, a); },
            number("c", logarithmic(1e-18, 1).also({0.9})), number("alpha", logarithmic(1e-4, 16)))
        .truth(
            [](double c, double a) {
                const long double q = static_cast<long double>(a) * a * (1.0L - static_cast<long double>(c) * c) / c / c;
                return static_cast<double>((std::sqrt(1.0L + q) - 1.0L) / 2.0L);
            },
            1e-9, 1e-19);
    smith.test(
        "smith_g1(c, alpha)", [](auto c, auto a) { return smith_g1(c, a); }, number("c", linear(0, 1)),
        number("alpha", logarithmic(1e-4, 16)));
    smith
        .test(
            "visibility_separable(l, v, alpha)", [](auto x, auto y, auto a) { return visibility_separable(x, y, a); }, l, v,
            pushed)
        .truth([](double x, double y, double a) { return 1 / ((1 + ggx_lambda(x, a)) * (1 + ggx_lambda(y, a)) * 4 * x * y); },
               1e-9);
    smith
        .test(
            "visibility_height_correlated_pushed(l, v, alpha)",
            [](auto x, auto y, auto a) { return visibility_height_correlated_pushed(x, y, a); }, l, v, pushed)
        .truth([](double x, double y, double a) { return ggx_visibility_textbook(x, y, a); }, 1e-9);
    smith.test(
        "visibility_schlick(l, v, k)", [](auto x, auto y, auto k) { return visibility_schlick(x, y, k); },
        number("l", linear(0, 1)), number("v", linear(0, 1)), number("k", logarithmic(1e-3, 1)));
    smith.test(
        "visibility_karis_ibl(l, v, alpha)", [](auto x, auto y, auto a) { return visibility_karis_ibl(x, y, a); },
        number("l", linear(0, 1)), number("v", linear(0, 1)), alpha);
    smith.test(
        "visibility_karis_direct(l, v, roughness)", [](auto x, auto y, auto r) { return visibility_karis_direct(x, y, r); },
        number("l", linear(0, 1)), number("v", linear(0, 1)), number("roughness", linear(0, 1)));
    smith.test(
        "visibility_hammon(l, v, alpha)", [](auto x, auto y, auto a) { return visibility_hammon(x, y, a); }, l, v,
        number("alpha", linear(0, 1)));
    smith.test(
        "visibility_kelemen(v_dot_h)", [](auto c) { return visibility_kelemen(c); },
        number("v_dot_h", linear(-0.1, 1).also({1e-4})));
    smith.test(
        "visibility_implicit()", [](auto c) { return visibility_implicit<decltype(c)>(); }, number("unused", values({0})));
    // Light and view changed over: the same to 4 ulp.
    smith.declare(
        "float near4(float a, float b) { return abs(a - b) <= 4.0 * 1.1920929e-7 * abs(b) ? 1.0 : 0.0; }"
        "vec4 symmetric(float l, float v, float a) {"
        "    return vec4(near4(visibility_separable(l, v, a), visibility_separable(v, l, a)),"
        "                near4(visibility_karis_ibl(l, v, a), visibility_karis_ibl(v, l, a)),"
        "                near4(visibility_height_correlated_pushed(l, v, a), visibility_height_correlated_pushed(v, l, a)),"
        "                near4(visibility_hammon(l, v, a), visibility_hammon(v, l, a))); }");
    smith
        .test(
            "symmetric(l, v, alpha)",
            [](auto x, auto, auto) {
                using T = decltype(x);
                return Vec4<T>{T(1), T(1), T(1), T(1)};
            },
            l, v, alpha)
        .named("visibility_symmetry");
    // What is visible is at most all: 4 n.l n.v V <= 1, to 8 ulp, so no pair of grazing directions shines.
    smith.declare(
        "float at_most_one(float x) { return x <= 1.0 + 9.6e-7 ? 1.0 : 0.0; }"
        "vec4 masking(float l, float v, float a) {"
        "    const float over = 4.0 * l * v;"
        "    return vec4(at_most_one(over * visibility_separable(l, v, a)), at_most_one(over * visibility_karis_ibl(l, v, a)),"
        "                at_most_one(over * visibility_height_correlated_pushed(l, v, a)),"
        "                at_most_one(over * visibility_hammon(l, v, a))); }");
    smith
        .test(
            "masking(l, v, alpha)",
            [](auto x, auto, auto) {
                using T = decltype(x);
                return Vec4<T>{T(1), T(1), T(1), T(1)};
            },
            l, v, alpha)
        .named("masking_at_most_one");
    smith.run();
}

}  // namespace
}  // namespace kiln::test
