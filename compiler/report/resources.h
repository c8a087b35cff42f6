#pragma once
// What members read, in a line each.

#include "compiler/report/family.h"

namespace kiln::report {

uint16_t half_of(float value);  // to nearest even; above 65504 infinite
float float_of_half(uint16_t half);

// "readonly buffer Name { float name[]; }" and the like.
Resource storage_buffer(const std::string& declaration, const std::vector<float>& values);

// "uniform Name { vec4 name[9]; }": std140, so whole vec4s. What a renderer keeps for the whole draw.
Resource uniform_buffer(const std::string& declaration, const std::vector<float>& values);

// Texels as Vulkan lays them out, or 32-bit floats a component when `format` is a float format that this can encode:
// r16_float, rg16_float, rgba16_float, r32_float, rg32_float, rgba32_float, rgba8_unorm, rgba8_srgb, rgb10a2_unorm,
// rg11b10_float, rgb9e5_float.
Bytes encode_texels(TexelFormat format, const std::vector<float>& components);
uint32_t components_of(TexelFormat format);

// `faces`: six faces after each other a mip, each size x size of components_of(format).
Resource cube_map(const std::string& name, TexelFormat format, uint32_t size, const std::vector<std::vector<float>>& mips);
Resource picture_map(const std::string& name, TexelFormat format, uint32_t width, uint32_t height,
                     const std::vector<std::vector<float>>& mips, SamplerState sampler);
// One mip in a BC format, already encoded.
Resource block_map(const std::string& name, TexelFormat format, uint32_t width, uint32_t height, Bytes blocks,
                   const SamplerState& sampler);
struct VolumeSize {
    uint32_t width = 0, height = 0, depth = 0;
};
Resource volume_map(const std::string& name, TexelFormat format, VolumeSize size, const std::vector<std::vector<float>>& mips);
Resource volume_map(const std::string& name, TexelFormat format, uint32_t side, const std::vector<std::vector<float>>& mips);
Resource depth_map(const std::string& name, uint32_t size, const std::vector<float>& depth, bool comparing, Filter filter);
// Layers of a map, one after the other; nearest, comparing or its numbers alone.
Resource depth_array(const std::string& name, uint32_t size, uint32_t layers, const std::vector<float>& depth,
                     bool comparing = true);

// Centre of a cube face's texel as a direction, not normalised. Faces +x -x +y -y +z -z, texels as Vulkan lays them.
Vec3d cube_direction(uint32_t face, double x, double y);

}  // namespace kiln::report
