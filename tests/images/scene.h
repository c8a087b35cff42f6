#pragma once
// The scene of the image tests: a sphere and a card seen from behind on a plane, one lamp, textures and shadow maps, as
// numbers that both the device and the reference read. Everything is of fp32; world space has y up, in metres.

#include <map>
#include <string>

#include "compiler/validate/device.h"
#include "uber/reference/render.h"
#include "uber/reference/surface.h"
#include "uber/reference/texture.h"

namespace kiln::test {

using reference::Bounded;
using V2 = reference::Vec2<double>;
using V3 = reference::Vec3<double>;
using V4 = reference::Vec4<double>;
using M4 = reference::Mat4<double>;

using Vertex = reference::SurfaceVertex<double>;

enum Body { sphere = 0, plane = 1, card = 2 };

struct Mesh {
    std::vector<Vertex> vertices;  // three a triangle
    std::vector<int> body;         // of each triangle
};

// The scene's textures, most by the shader's names, and how reference::surface_radiance reads them.
struct Maps {
    reference::Texture2D base_map, specular_map, gloss_map, roughness_map, metallic_map, normal_map;
    reference::Texture2D lightmap_flat, lightmap_l0, lightmap_l1_y, lightmap_l1_z, lightmap_l1_x;
    reference::CubeArray environment_maps;
    reference::Texture2D split_sum_table;
    // What the lamp sees: depths; moments, averaged in mips and summed from the corner; a layer a cascade.
    std::shared_ptr<const reference::DepthMap> shadow_map;
    reference::MomentMips moment_mips;
    reference::Texture2D moment_sums;
    reference::DepthCube shadow_cube;
    reference::CubeArray moments_cube_map;
    std::vector<reference::DepthMap> cascade_maps;

    template <class T>
    T shadow(const reference::Vec2<T>& uv, const T& depth) const {
        return reference::filtered_comparison(*shadow_map, uv, depth);
    }
    template <class T>
    T depth(const reference::Vec2<T>& uv) const {
        return reference::nearest_depth(*shadow_map, uv);
    }
    template <class T>
    T cascade(int layer, const reference::Vec2<T>& uv, const T& depth) const {
        return reference::filtered_comparison(cascade_maps[static_cast<size_t>(layer)], uv, depth);
    }
    template <class T>
    reference::Vec2<T> moments(const reference::Vec2<T>& uv, const T& level) const {
        return moment_mips(uv, level);
    }
    template <class T>
    reference::Vec2<T> moments_sum(int x, int y) const {
        return {T(moment_sums.texel(x, y, 0)), T(moment_sums.texel(x, y, 1))};
    }
    int moments_size() const { return static_cast<int>(moment_sums.width()); }
    template <class T>
    reference::Vec2<T> moments_cube(const reference::Vec3<T>& d) const {
        return moments_cube_map(d, 0, T(0)).xy();
    }
};

struct Scene {
    Mesh mesh;
    reference::SurfaceBlocks blocks;
    Maps maps;
};

// directional: the lamp is a sun, and the shadow map orthographic. filtered: most textures are bilinear; else all are nearest,
// so that no sampler's weights, which Vulkan allows to be coarse, stand between shading and its bound.
const Scene& scene(bool directional, bool filtered);

// Sizes and distances that blocks and maps share.
inline constexpr double shadow_near = 2, shadow_far = 20;
inline constexpr int shadow_size = 256, face_size = 256, moments_size = 64, cascade_size = 128, sky_side = 64, sky_levels = 5;
inline constexpr int split_sum_side = 32;

Mesh make_mesh();
reference::SurfaceBlocks make_blocks(bool directional);
Maps make_maps(const Mesh& mesh, bool directional, bool filtered);

// One texel of grey.
reference::Texture2D plain(double v);

// A material that takes nothing from the light but what its BRDF takes, without emission or ambient light. specular: F0 or ks
// where a material has a map of it.
void make_white(Scene& s, double base, double specular, double roughness, double metallic);

double f32(double x);
V3 f32(const V3& v);
M4 f32(const M4& m);

// ---- for the device ----

struct NamedTexture {
    std::shared_ptr<const ImageData> image;
    SamplerState sampler;
};

// What a shader's blocks, textures and vertex inputs hold, by their names.
struct NamedInputs {
    std::map<std::string, std::vector<double>> members;
    std::map<std::string, NamedTexture> textures;
    std::map<std::string, std::vector<std::vector<float>>> attributes;  // a vector a vertex
};

void put(NamedInputs& out, const Mesh& mesh);
void put(NamedInputs& out, const reference::SurfaceBlocks& blocks);
void put(NamedInputs& out, const Maps& maps, const reference::SurfaceAxes& axes);
NamedInputs inputs_of(const Scene& scene, const reference::SurfaceAxes& axes = {});

// Everything that these stages take, bound by name at the place that the reflection says. A name that is missing fails the
// test.
Inputs bound(const std::vector<StageCode>& stages, const NamedInputs& inputs);

}  // namespace kiln::test
