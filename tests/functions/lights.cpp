#include "uber/reference/lights.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Lights) {
    Functions lights("lights.glsl");
    lights.test(
        "distance_attenuation(distance_squared, range)",
        [](auto distance_squared, auto range) { return distance_attenuation(distance_squared, range); },
        number("distance_squared", logarithmic(1e-6, 1e6).also({1e-4}).with({0, 1e-20, 1e-40, 1e10})),
        number("range", logarithmic(1e-2, 1e3).with({1e-7, 1e-6, 1e-5})));
    lights.test(
        "cone_attenuation(cos_angle, cos_inner, cos_outer)",
        [](auto cos_angle, auto cos_inner, auto cos_outer) { return cone_attenuation(cos_angle, cos_inner, cos_outer); },
        number("cos_angle", linear(-1, 1)), number("cos_inner", linear(-1, 1)), number("cos_outer", linear(-1, 1)));
    lights.test(
        "point_light_intensity(lumen)", [](auto lumen) { return point_light_intensity(lumen); },
        number("lumen", logarithmic(1e-3, 1e7).with({0})));
    lights.test(
        "spot_light_intensity(lumen)", [](auto lumen) { return spot_light_intensity(lumen); },
        number("lumen", logarithmic(1e-3, 1e7).with({0})));
    lights.run();
}

}  // namespace
}  // namespace kiln::test
