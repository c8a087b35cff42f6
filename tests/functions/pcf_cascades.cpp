#include "uber/reference/pcf_cascades.h"

#include "tests/functions/cascade_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, PcfCascades) {
    Functions pcf("pcf_cascades.glsl");
    const DepthTexture texture = blocks(32);
    pcf.texture("sampler2DArrayShadow maps", texture.image(true), nearest(true));
    const auto compare = [&texture](int layer, auto uv, auto depth) { return texture.compare(uv, depth, layer); };
    for (const int n : {3, 5, 7})
        pcf.test(
               "cascade_pcf(maps, vec4(x, y, z, w), layer, slope, 1e-4, width, " + std::to_string(n) + ")",
               [compare, n](auto x, auto y, auto z, auto w, int layer, auto slope, auto width) {
                   using T = decltype(x);
                   return cascade_pcf(compare, Vec4<T>{x, y, z, w}, layer, slope, T(1e-4), width, n);
               },
               // Not w to 1.5: 1.2 / 1.5 and a fifth of the widest box put taps of n = 5 exactly on the map's border, and whole
               // families of extremes were undecided. What is left: extremes where x or y is w, and, where one of n coordinates
               // an axis is within 1e-6 of one of 8 blocks' edges: 2 x 7 x 8 x 2e-6 = 2e-4.
               number("x", linear(-1.2, 1.2)), number("y", linear(-1.2, 1.2)), number("z", linear(-0.2, 1.2)),
               number("w", linear(-0.2, 1.45).also({0})), integer("layer", 0, 3), vector2("slope", linear(-0.3, 0.3)),
               number("width", logarithmic(1e-3, 0.5)))
            .named("cascade_pcf_" + std::to_string(n))
            .undecided(0.002);
    // Near the slices' border, where the choice of one or two layers is the matter; planes up to the steepest.
    pcf.test(
           "cascaded_pcf(maps, vec4(at, 1.0), vec4(n, 0.0), vec4(next, 1.0), vec4(n.yzx, 0.0), vec2(0.2, 0.1), 0.03125, 1e-4, "
           "choose_cascade(depth, 0.1, vec4(10.0, 20.0, 30.0, 40.0), 4, 0.2), 3)",
           [compare](auto at, auto next, auto n, auto depth) {
               using T = decltype(depth);
               const CascadeChoice<T> choice = choose_cascade(depth, T(0.1), Vec4<T>{T(10), T(20), T(30), T(40)}, 4, T(0.2));
               return cascaded_pcf(compare, Vec4<T>{at.x, at.y, at.z, T(1)}, Vec4<T>{n.x, n.y, n.z, T(0)},
                                   Vec4<T>{next.x, next.y, next.z, T(1)}, Vec4<T>{n.y, n.z, n.x, T(0)}, Vec2<T>{T(0.2), T(0.1)},
                                   T(0.03125), T(1e-4), choice, 3);
           },
           vector3("at", linear(-1.2, 1.2)), vector3("next", linear(-1.2, 1.2)), unit("n"),
           number("depth", linear(0, 42).also({10, 20, 30, 40})))
        .named("cascaded_pcf");
    pcf.run();
}

}  // namespace
}  // namespace kiln::test
