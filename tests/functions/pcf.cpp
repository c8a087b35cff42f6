#include "uber/reference/pcf.h"

#include "tests/functions/shadow_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Pcf) {
    Functions pcf("pcf.glsl");
    pcf.test(
        "turned(point, cos_sin)", [](auto point, auto cos_sin) { return turned(point, cos_sin); },
        vector2("point", linear(-1, 1)), vector2("cos_sin", linear(-1, 1)));
    // Integers and a division by a power of two: exact.
    pcf.test(
           "pixel_hash(uvec2(x, y)) + zero",
           [](auto zero, uint32_t x, uint32_t y) { return zero + decltype(zero)(pixel_hash(x, y)); }, number("zero", values({0})),
           bits("x"), bits("y"))
        .undecided(0)
        .unbounded(0);

    const DepthTexture texture = depth_texture(fence_scene(), LightView{1, 20, 2}, 64);
    pcf.texture("sampler2DShadow map", texture.image(), nearest(true));
    const auto place = [] { return vector3("place", linear(0, 1)); };
    const auto slope = [] { return vector2("slope", linear(-0.3, 0.3)); };
    const auto width = [] { return vector2("width", logarithmic(1e-3, 0.5)); };
    const auto compare = [&texture](auto uv, auto depth) { return texture.compare(uv, depth); };
    pcf.test(
        "shadow_tap(map, place, slope, 1e-4, offset)",
        [compare](auto place_, auto slope_, auto offset) {
            return shadow_tap(compare, place_, slope_, decltype(offset.x)(1e-4), offset);
        },
        place(), slope(), vector2("offset", linear(-0.3, 0.3)));
    for (const int n : {3, 5, 7})
        pcf.test(
            "pcf_" + std::to_string(n) + "(map, place, slope, 1e-4, width)",
            [compare, n](auto place_, auto slope_, auto width_) {
                return pcf_box(compare, place_, slope_, decltype(width_.x)(1e-4), width_, n);
            },
            place(), slope(), width());
    pcf.test(
        "pcf_poisson_16(map, place, slope, 1e-4, width, turn)",
        [compare](auto place_, auto slope_, auto width_, auto turn) {
            return pcf_poisson_16(compare, place_, slope_, decltype(turn)(1e-4), width_, turn);
        },
        place(), slope(), width(), number("turn", linear(0, 1)));
    pcf.test(
        "pcf_poisson_32(map, place, slope, 1e-4, width, turn)",
        [compare](auto place_, auto slope_, auto width_, auto turn) {
            return pcf_poisson_32(compare, place_, slope_, decltype(turn)(1e-4), width_, turn);
        },
        place(), slope(), width(), number("turn", linear(0, 1)));
    pcf.run();
}

}  // namespace
}  // namespace kiln::test
