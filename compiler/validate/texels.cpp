#include "compiler/validate/texels.h"

#include <algorithm>
#include <iterator>

namespace kiln {

namespace {

struct Row {
    const char* name;
    TexelBlock block;
};
// By TexelFormat.
constexpr Row rows[] = {
    {"standard", {1, 16}},    {"rgba8_unorm", {1, 4}},   {"rgba8_srgb", {1, 4}},    {"r8_unorm", {1, 1}},
    {"rg8_unorm", {1, 2}},    {"r16_unorm", {1, 2}},     {"rg16_unorm", {1, 4}},    {"rgba16_unorm", {1, 8}},
    {"r16_float", {1, 2}},    {"rg16_float", {1, 4}},    {"rgba16_float", {1, 8}},  {"r32_float", {1, 4}},
    {"rg32_float", {1, 8}},   {"rgba32_float", {1, 16}}, {"rgb10a2_unorm", {1, 4}}, {"rg11b10_float", {1, 4}},
    {"rgb9e5_float", {1, 4}}, {"bc1_rgb_unorm", {4, 8}}, {"bc1_rgb_srgb", {4, 8}},  {"bc3_unorm", {4, 16}},
    {"bc3_srgb", {4, 16}},    {"bc4_unorm", {4, 8}},     {"bc5_unorm", {4, 16}},    {"bc6h_ufloat", {4, 16}},
    {"bc7_unorm", {4, 16}},   {"bc7_srgb", {4, 16}},     {"d16_unorm", {1, 2}},     {"d32_float", {1, 4}},
};
static_assert(std::size(rows) == static_cast<size_t>(TexelFormat::d32_float) + 1);

const Row& row_of(TexelFormat format) {
    const size_t i = static_cast<size_t>(format);
    return rows[i < std::size(rows) ? i : 0];
}

}  // namespace

TexelBlock block_of(TexelFormat format, bool depth) {
    if (format == TexelFormat::standard && depth) return {1, 4};
    return row_of(format).block;
}

const char* name_of(TexelFormat format) { return row_of(format).name; }

size_t mip_bytes(const ImageData& image, uint32_t mip) {
    const TexelBlock block = block_of(image.format, image.depth);
    const auto blocks = [&](uint32_t size) { return (size_t{std::max(1u, size >> mip)} + block.side - 1) / block.side; };
    return blocks(image.width) * blocks(image.height) * std::max(1u, image.slices >> mip) * image.layers * block.bytes;
}

size_t image_bytes(const ImageData& image) {
    size_t out = 0;
    for (uint32_t mip = 0; mip < image.mips; ++mip) out += mip_bytes(image, mip);
    return out;
}

}  // namespace kiln
