#include "uber/reference/fresnel_exact.h"

#include <complex>

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

// Over complex numbers, for a medium of index m.
double fresnel_textbook(double cosine, std::complex<double> m) {
    const double c = std::min(std::max(cosine, 0.0), 1.0);
    if (m == 1.0) return 0;  // also at c = 0, where the limit in c is taken and the quotient has none
    const std::complex<double> root = std::sqrt(m * m - (1.0 - c * c));
    return 0.5 * (std::norm((c - root) / (c + root)) + std::norm((m * m * c - root) / (m * m * c + root)));
}

TEST(Functions, FresnelExact) {
    Functions fresnel("fresnel_exact.glsl");
    fresnel.test(
        "dielectric_f0(ior)", [](auto ior) { return dielectric_f0(ior); }, number("ior", logarithmic(0.1, 1e3).also({1})));
    fresnel.test(
        "dielectric_ior(f0)", [](auto f0) { return dielectric_ior(f0); }, number("f0", linear(-0.1, 1.1).also({0, 0.999})));
    // From 1 on nothing reflects totally; the textbook differences lose 1e-16 / (n - 1)^2 of a double's digits.
    fresnel
        .test(
            "fresnel_dielectric(cosine, ior)", [](auto cosine, auto ior) { return fresnel_dielectric(cosine, ior); },
            number("cosine", linear(-0.1, 1.1).also({0, 1})), number("ior", logarithmic(1, 100)))
        .truth([](double cosine, double ior) { return fresnel_textbook(cosine, ior); }, 1e-9, 1e-13);
    fresnel
        .test(
            "fresnel_dielectric(cosine, ior)", [](auto cosine, auto ior) { return fresnel_dielectric(cosine, ior); },
            number("cosine", linear(0, 1)), number("ior", linear(0.2, 0.99)))
        .named("fresnel_dielectric_inside")
        .truth([](double cosine, double ior) { return fresnel_textbook(cosine, ior); }, 1e-9, 1e-13);
    fresnel
        .test(
            "fresnel_conductor(cosine, eta, k)", [](auto cosine, auto eta, auto k) { return fresnel_conductor(cosine, eta, k); },
            number("cosine", linear(-0.1, 1.1).also({0, 1})), vector3("eta", logarithmic(0.02, 20)),
            vector3("k", logarithmic(0.02, 20)))
        .truth(
            [](double cosine, auto eta, auto k) {
                return Vec3<double>{fresnel_textbook(cosine, {eta.x, k.x}), fresnel_textbook(cosine, {eta.y, k.y}),
                                    fresnel_textbook(cosine, {eta.z, k.z})};
            },
            1e-9, 1e-13);
    fresnel.run();
}

}  // namespace
}  // namespace kiln::test
