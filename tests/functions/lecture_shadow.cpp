#include "uber/reference/lecture_shadow.h"
#include "uber/reference/pcf.h"

#include "tests/functions/shadow_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

// The printed forms compute what they print; what that does to an image is in shadow_images.cpp.
TEST(Functions, LectureShadow) {
    Functions lecture("lecture_shadow.glsl");
    lecture.test(
        "pcss_penumbra_width_lecture(receiver, blocker, size)",
        [](auto receiver, auto blocker, auto size) { return pcss_penumbra_width_lecture(receiver, blocker, size); },
        number("receiver", linear(0, 100)), number("blocker", logarithmic(1e-3, 100)), number("size", linear(0, 5)));
    lecture.test(
        "pcss_mean_blocker_lecture(sum, count)", [](auto sum, auto count) { return pcss_mean_blocker_lecture(sum, count); },
        number("sum", linear(0, 1000)), number("count", linear(1, 64)));
    lecture.test(
        "shadow_moments_lecture(depth)", [](auto depth) { return shadow_moments_lecture(depth); }, number("depth", linear(0, 1)));
    lecture.test(
        "moments_variance_lecture(moments)", [](auto moments) { return moments_variance_lecture(moments); },
        vector2("moments", linear(0, 1)));
    // Where it has a value: its variance and distance from the mean not both near 0.
    lecture.test(
        "chebyshev_lecture(vec2(m, m * m + v), t)",
        [](auto m, auto v, auto t) {
            return chebyshev_lecture(Vec2<decltype(m)>{m, m * m + v}, t);
        },
        number("m", linear(0.1, 0.9)), number("v", logarithmic(1e-3, 0.2)), number("t", linear(0, 1)));
    const DepthTexture texture = depth_texture(square_scene(6), LightView{1, 20, 2}, 64);
    lecture.texture("sampler2D map", texture.image(), nearest(false));
    const auto read = [&texture](auto uv) { return texture.read(uv); };
    lecture.test(
        "shadow_factor_lecture(map, vec4(x, y, z, w))",
        [read](auto x, auto y, auto z, auto w) {
            return shadow_factor_lecture(read, Vec4<decltype(x)>{x, y, z, w});
        },
        number("x", linear(-2, 2)), number("y", linear(-2, 2)), number("z", linear(-1, 2)), number("w", linear(0.1, 2)));
    lecture.test(
        "shadow_factor_unbiased_lecture(map, vec4(x, y, z, w))",
        [read](auto x, auto y, auto z, auto w) {
            return shadow_factor_unbiased_lecture(read, Vec4<decltype(x)>{x, y, z, w});
        },
        number("x", linear(-2, 2)), number("y", linear(-2, 2)), number("z", linear(-1, 2)), number("w", linear(0.1, 2)));
    // Four layers whose matrices shift the receiver by quarters of the map.
    DepthTexture layers{16, {}};
    for (uint32_t i = 0; i < 4 * 16 * 16; ++i) layers.depths.push_back(static_cast<float>(pixel_hash(i, 7)));
    lecture.texture("sampler2DArrayShadow maps", layers.image(true), nearest(true));
    lecture.declare(
        "mat4 shifted(int i) { mat4 m = mat4(1.0); m[3].x = 0.25 * float(i); return m; }\n"
        "mat4 matrices[4] = mat4[4](shifted(0), shifted(1), shifted(2), shifted(3));");
    int samples = 0;
    lecture
        .test(
            "cascaded_shadow_lecture(maps, matrices, receiver, count, count - 1)",
            [&layers, &samples](auto receiver, int count) {
                using T = decltype(receiver.x);
                Mat4<T> matrices[4];
                for (int i = 0; i < 4; ++i)
                    matrices[i] = {{{T(1), T(0), T(0), T(0)},
                                    {T(0), T(1), T(0), T(0)},
                                    {T(0), T(0), T(1), T(0)},
                                    {T(0.25 * i), T(0), T(0), T(1)}}};
                const auto maps = [&](int layer, const Vec2<T>& uv, const T& depth) {
                    return ++samples, layers.compare(uv, depth, layer);
                };
                samples = 0;
                const T lit = cascaded_shadow_lecture(maps, matrices, receiver, count, count - 1);
                EXPECT_EQ(samples, count);  // B30: one would do
                return lit;
            },
            vector3("receiver", linear(-1, 1)), integer("count", 1, 4))
        .named("cascaded_shadow_lecture");
    lecture.run();
}

}  // namespace
}  // namespace kiln::test
