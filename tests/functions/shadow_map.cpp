#include "uber/reference/shadow_map.h"

#include <cstring>
#include <random>

#include "tests/functions/function.h"
#include "uber/reference/depth_map.h"

namespace kiln::test {
namespace {

using namespace reference;

std::shared_ptr<ImageData> depth_image(ImageDim dim, uint32_t side, const std::vector<float>& texels) {
    auto image = std::make_shared<ImageData>();
    image->dim = dim;
    image->depth = true;
    image->width = image->height = side;
    image->layers = dim == ImageDim::cube ? 6 : 1;
    image->texels.resize(texels.size() * sizeof(float));
    std::memcpy(image->texels.data(), texels.data(), image->texels.size());
    return image;
}

TEST(Functions, ShadowMap) {
    Functions shadow("shadow_map.glsl");
    shadow.test(
        "offset_shadow_receiver(position, n, cosine, texel)",
        [](auto position, auto n, auto cosine, auto texel) { return offset_shadow_receiver(position, n, cosine, texel); },
        vector3("position", either_sign(1e-2, 1e4)), unit("n"), number("cosine", linear(-1, 1)),
        number("texel", logarithmic(1e-4, 10)));
    shadow.test(
        "cube_axis_cosine(from_light, n, texel)",
        [](auto from_light, auto n, auto texel) { return cube_axis_cosine(from_light, n, texel); },
        vector3("from_light", either_sign(1e-2, 1e4)), unit("n"), number("texel", logarithmic(1e-4, 1)));
    shadow.test(
        "perspective_axis_cosine(mat4(vec4(0.0, 0.0, 0.0, row.x), vec4(0.0, 0.0, 0.0, row.y), vec4(0.0, 0.0, 0.0, row.z), "
        "vec4(1.0)), n)",
        [](auto row, auto n) {
            using T = decltype(row.x);
            const T o(0);
            return perspective_axis_cosine(
                Mat4<T>{{{o, o, o, row.x}, {o, o, o, row.y}, {o, o, o, row.z}, {T(1), T(1), T(1), T(1)}}}, n);
        },
        unit("row"), unit("n"));

    std::mt19937 random(104);
    std::vector<float> texels(8 * 8);
    for (float& t : texels) t = static_cast<float>(random() % 1024) / 1024;
    const DepthMap map(8, 8, texels);
    shadow.texture("sampler2DShadow map", depth_image(ImageDim::d2, 8, texels));
    shadow.test(
        "shadow_factor_2d(map, vec4(ndc * w, w), bias)",
        [&map](auto ndc, auto w, auto bias) {
            return shadow_factor_2d(map, Vec4<decltype(w)>{ndc.x * w, ndc.y * w, ndc.z * w, w}, bias);
        },
        vector3("ndc", linear(-1.1, 1.1)), number("w", logarithmic(1e-3, 1e3).with({0, -1, -1e-20})),
        number("bias", linear(0, 0.01)));

    const FaceDepths faces{{0.1, 0.25, 0.5, 0.75, 0.9, 0.97}};
    std::vector<float> cube;
    for (const double depth : faces.depth) cube.insert(cube.end(), 8 * 8, static_cast<float>(depth));
    shadow.texture("samplerCubeShadow cube", depth_image(ImageDim::cube, 8, cube));
    shadow
        .test(
            "shadow_factor_cube(cube, from_light, near, far, bias)",
            [&faces](auto from_light, auto near, auto far, auto bias) {
                return shadow_factor_cube(faces, from_light, near, far, bias);
            },
            vector3("from_light", either_sign(1e-2, 100)), number("near", logarithmic(0.01, 1)),
            number("far", logarithmic(2, 200)), number("bias", linear(0, 0.01)))
        .skip([](auto d, double, double, double) {  // within a texel of a face's edge, where two faces are filtered
            double a[] = {std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
            std::sort(a, a + 3);
            return a[1] > 0.75 * a[2];
        });
    shadow
        .test(
            "shadow_factor_cube(cube, vec3(0.0, -z, 0.0), near, far, bias)",
            [&faces](auto z, auto near, auto far, auto bias) {
                using T = decltype(z);
                return shadow_factor_cube(faces, Vec3<T>{T(0), -z, T(0)}, near, far, bias);
            },
            number("z", values({0.125, 0.25, 0.5, 1, 2, 4, 8, 16})), number("near", values({0.25, 0.5, 1})),
            number("far", values({2, 4, 8})), number("bias", linear(0, 0.01)))
        .named("shadow_factor_cube_at_the_ends");
    shadow.run();
}

}  // namespace
}  // namespace kiln::test
