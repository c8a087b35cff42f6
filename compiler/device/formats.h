#pragma once
// Texel formats: which Vulkan format stands for a SPIR-V one, and how 32-bit components go into it and come out again.
// Internal to compiler/device.

#include <vulkan/vulkan.h>

#include "compiler/validate/device.h"

namespace kiln {

enum class Coding : uint8_t { floating, unorm, snorm, sint, uint, packed11, packed10_unorm, packed10_uint, depth };

struct Format {
    VkFormat vk = VK_FORMAT_R32G32B32A32_SFLOAT;
    Coding coding = Coding::floating;
    uint32_t components = 4;
    uint32_t bits = 32;  // of a component; 32 a texel for the packed ones
    uint32_t texel_bytes() const { return coding >= Coding::packed11 ? 4 : components * bits / 8; }
    BaseType base() const;  // of an unpacked component
};

// The format of a SPIR-V ImageFormat number; for 0 (unknown), four 32-bit components of `base`.
Format format_of(uint32_t spirv_format, BaseType base);
Format depth_format();
// What an image that is sampled is stored as; for encoded formats, `vk` and whether it is depth are all that is told.
Format format_of(const ImageData& image);

// `words`: four 32-bit components a texel (one for depth), in the shader's type.
Bytes pack_texels(const Format& format, ByteView words);
// The same way back: `components` words a texel.
std::vector<uint32_t> unpack_texels(const Format& format, ByteView texels);

VkFormat vertex_format(BaseType base, uint32_t components);

}  // namespace kiln
