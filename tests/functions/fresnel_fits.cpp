#include "uber/reference/fresnel_fits.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, FresnelFits) {
    Functions fresnel("fresnel_fits.glsl");
    const auto cosine = number("cosine", linear(-0.1, 1.1).also({0, 1}));
    fresnel.test(
        "fresnel_schlick_f90(cosine, f0, f90)", [](auto c, auto f0, auto f90) { return fresnel_schlick_f90(c, f0, f90); }, cosine,
        colour("f0"), colour("f90"));
    fresnel.test(
        "fresnel_schlick_pow(cosine, f0)", [](auto c, auto f0) { return fresnel_schlick_pow(c, f0); }, cosine, colour("f0"));
    fresnel
        .test(
            "fresnel_spherical_gaussian(cosine, f0)", [](auto c, auto f0) { return fresnel_spherical_gaussian(c, f0); }, cosine,
            colour("f0"))
        .truth([](auto c, auto f0) { return fresnel_schlick(c, f0); }, 0, 3.77e-3);
    fresnel.test(
        "fresnel_f82(cosine, f0, f82)", [](auto c, auto f0, auto f82) { return fresnel_f82(c, f0, f82); }, cosine, colour("f0"),
        colour("f82"));
    // Pushed far out of range; f90 is 0 or 1 there, whatever the colour.
    fresnel.test(
        "fresnel_schlick_pushed(cosine, f0)", [](auto c, auto f0) { return fresnel_schlick_pushed(c, f0); },
        number("cosine", linear(-1, 2).also({0, 1})), vector3("f0", either_sign(1e-3, 1e6)));
    fresnel.run();
}

}  // namespace
}  // namespace kiln::test
