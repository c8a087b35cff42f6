#include "uber/reference/environment_layers.h"

#include "tests/functions/shadow_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, EnvironmentLayers) {
    // Three cubes of one texel a face, each texel its own colour: which one is read shows layer and face.
    auto cubes = std::make_shared<ImageData>();
    cubes->dim = ImageDim::cube;
    cubes->arrayed = true;
    cubes->format = TexelFormat::rgba32_float;
    cubes->width = cubes->height = 1;
    cubes->layers = 18;
    std::vector<float> texels;
    for (int i = 0; i < 18; ++i) texels.insert(texels.end(), {static_cast<float>(i), static_cast<float>(i * i), 0.25f, 1});
    cubes->texels = texels_of(texels);

    Functions environment("environment_layers.glsl");
    environment.texture("samplerCubeArray maps", cubes, nearest(false));
    environment.test(
        "sample_environment_layer(maps, layer, r, roughness, 1.0)",
        [](int layer, auto r, auto roughness) {
            using T = decltype(roughness);
            const auto maps = [](int l, const Vec3<T>& d, const T&) {
                const int i = 6 * l + cube_face(d);
                return Vec3<T>{T(i), T(i * i), T(0.25)};
            };
            return sample_environment_layer(maps, layer, r, roughness, T(1));
        },
        integer("layer", 0, 2), vector3("r", either_sign(1e-3, 1e3)), number("roughness", linear(0, 1)));
    environment.run();
}

}  // namespace
}  // namespace kiln::test
