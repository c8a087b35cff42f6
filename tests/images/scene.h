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

struct Vertex {
    V3 position, normal;
    V2 uv, lightmap_uv;
};

enum Body { sphere = 0, plane = 1, card = 2 };

struct Mesh {
    std::vector<Vertex> vertices;  // three a triangle
    std::vector<int> body;         // of each triangle
};

// The scene's textures by the shader's names.
struct Maps {
    reference::Texture2D base_map, specular_map, gloss_map, roughness_map, metallic_map;
    reference::Texture2D lightmap_flat, lightmap_l0, lightmap_l1_y, lightmap_l1_z, lightmap_l1_x;
    std::shared_ptr<reference::DepthMap> shadow_map;
    reference::DepthCube shadow_cube;
    template <class T>
    T shadow(const reference::Vec2<T>& uv, const T& depth) const {
        return reference::filtered_comparison(*shadow_map, uv, depth);
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

NamedTexture texture_of(const reference::Texture2D& from);
NamedTexture texture_of(const reference::DepthMap& from);
NamedTexture texture_of(const reference::DepthCube& from);
void put(NamedInputs& out, const Mesh& mesh);
void put(NamedInputs& out, const reference::SurfaceBlocks& blocks);
void put(NamedInputs& out, const Maps& maps);
NamedInputs inputs_of(const Scene& scene);

// Everything that these stages take, bound by name at the place that the reflection says. A name that is missing fails the
// test.
Inputs bound(const std::vector<StageCode>& stages, const NamedInputs& inputs);

}  // namespace kiln::test
