#include "uber/reference/hair.h"

#include "tests/functions/function.h"
#include "uber/reference/hair_textbook.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Bessel) {
    Functions bessel("bessel.glsl");
    bessel
        .test(
            "bessel_i0_scaled(x)", [](auto x) { return bessel_i0_scaled(x); },
            number("x", logarithmic(1e-6, 1e6).also({3.75}).with({0})))
        .truth([](double x) { return bessel_i0_scaled_textbook(x); }, 5e-7);
    bessel
        .test(
            "bessel_k0_scaled(x)", [](auto x) { return bessel_k0_scaled(x); }, number("x", logarithmic(1e-20, 1e6).also({2})))
        .truth([](double x) { return bessel_k0_scaled_textbook(x); }, 3e-7);
    bessel.run();
}

// sin and cos of one angle, as near as floats give them, so that si^2 + ci^2 is 1 to 1e-7.
template <class T>
Vec2<T> pair_of(const Vec3<T>& unit) {
    return {unit.x, length(Vec2<T>{unit.y, unit.z})};
}

TEST(Functions, Hair) {
    Functions hair("hair.glsl");
    const auto eta = number("eta", linear(1.05, 2.5));
    hair.test(
            "hair_fresnel(cosine, eta)", [](auto cosine, auto e) { return hair_fresnel(cosine, e); },
            number("cosine", linear(0, 1)), eta)
        .truth([](double cosine, double e) { return hair_fresnel_textbook(cosine, e); }, 1e-9, 1e-14);
    hair.test(
            "hair_variance(p, beta)", [](auto p, auto beta) { return hair_variance(p, beta); }, integer("p", 0, 3),
            number("beta", linear(0.05, 1)))
        .truth([](int p, double beta) { return hair_variance_textbook(p, beta); }, 1e-12);
    hair.test(
            "hair_logistic_scale(beta)", [](auto beta) { return hair_logistic_scale(beta); }, number("beta", linear(0.05, 1)))
        .truth([](double beta) { return hair_logistic_scale_textbook(beta); }, 1e-12);
    // Row 34: every v down to 1e-5. The truth is taken where the pairs are units in double; as rounded they are not by up to
    // 1.2e-7, which the textbook form, divided by v, would take for an angle.
    hair.test(
            "vec2 a = vec2(l.x, length(l.yz)), b = vec2(e.x, length(e.yz)); result = hair_longitudinal(a.x, a.y, b.x, b.y, v);",
            [](auto l, auto e, auto v) {
                const auto a = pair_of(l), b = pair_of(e);
                return hair_longitudinal(a.x, a.y, b.x, b.y, v);
            },
            unit("l"), unit("e"), number("v", logarithmic(1e-5, 10).also({0.0112, 0.1})))
        .named("hair_longitudinal");
    hair.test(
            "hair_azimuthal(phi, p, s, gamma_o, gamma_t)",
            [](auto phi, auto p, auto s, auto gamma_o, auto gamma_t) { return hair_azimuthal(phi, p, s, gamma_o, gamma_t); },
            number("phi", linear(-6.28, 6.28)), integer("p", 0, 2), number("s", logarithmic(1e-3, 5)),
            number("gamma_o", linear(-1.57, 1.57)), number("gamma_t", linear(-1.57, 1.57)))
        .truth([](double phi, int p, double s, double gamma_o,
                  double gamma_t) { return hair_azimuthal_textbook(phi, p, s, gamma_o, gamma_t); },
               1e-9, 1e-30);
    hair.test(
            "hair_attenuation(p, f, t)", [](auto p, auto f, auto t) { return hair_attenuation(p, f, t); }, integer("p", 0, 3),
            number("f", linear(0, 1)), colour("t"))
        .truth([](int p, double f, auto t) { return hair_attenuation_textbook(p, f, t); }, 1e-6, 1e-9);
    hair.test(
        "hair_transmittance(absorption, g, c)", [](auto a, auto g, auto c) { return hair_transmittance(a, g, c); },
        vector3("absorption", logarithmic(1e-3, 100).with({0})), number("g", linear(0, 1)), number("c", linear(0.3, 1)));
    hair.test(
            "hair_absorption(c, beta)", [](auto c, auto beta) { return hair_absorption(c, beta); }, colour("c"),
            number("beta", linear(0.05, 1)))
        .truth([](auto c, double beta) { return hair_absorption_textbook(c, beta); }, 1e-10, 1e-15);
    hair.test(
            "result = hair_chiang(HairFibre(absorption, eta, beta_m, beta_n, tilt), l, e, h);",
            [](auto absorption, auto e_t_a, auto beta_m, auto beta_n, auto tilt, auto l, auto e, auto h) {
                return hair_chiang({absorption, e_t_a, beta_m, beta_n, tilt}, l, e, h);
            },
            vector3("absorption", logarithmic(1e-3, 10).with({0})), eta, number("beta_m", linear(0.05, 1)),
            number("beta_n", linear(0.05, 1)), number("tilt", linear(-0.2, 0.2)), unit("l"), unit("e"),
            number("h", linear(-1, 1)))
        .named("hair_chiang");
    hair.run();
}

}  // namespace
}  // namespace kiln::test
