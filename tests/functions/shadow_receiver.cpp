#include "uber/reference/shadow_receiver.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, ShadowReceiver) {
    Functions receiver("shadow_receiver.glsl");
    receiver.test(
        "shadow_coordinates(vec4(x, y, z, w))",
        [](auto x, auto y, auto z, auto w) {
            return shadow_coordinates(Vec4<decltype(x)>{x, y, z, w});
        },
        number("x", linear(-3, 3)), number("y", linear(-3, 3)), number("z", linear(-1, 3)), number("w", linear(-1, 3).also({0})));
    receiver.test(
        "receiver_depth_slope(plane, limit)", [](auto plane, auto limit) { return receiver_depth_slope(plane, limit); },
        vector4("plane", linear(-1, 1)), number("limit", values({1, 64})));
    receiver
        .test(
            "receiver_depth_slope(dx, dy, 64.0)",
            [](auto dx, auto dy) { return receiver_depth_slope(dx, dy, decltype(dx.x)(64)); }, vector3("dx", linear(-1, 1)),
            vector3("dy", linear(-1, 1)))
        .named("receiver_depth_slope_of_derivatives");
    receiver.test(
        "receiver_depth_bias(slope, reach, quantum)",
        [](auto slope, auto reach, auto quantum) { return receiver_depth_bias(slope, reach, quantum); },
        vector2("slope", linear(-64, 64)), vector2("reach", logarithmic(1e-5, 0.1)), number("quantum", logarithmic(6e-8, 1e-4)));
    receiver.run();
}

}  // namespace
}  // namespace kiln::test
