#include "compiler/device/formats.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace kiln {

namespace {

// Indexed by SPIR-V's ImageFormat (specification 1.6, section 3.11).
constexpr Format formats[] = {
    {VK_FORMAT_R32G32B32A32_SFLOAT, Coding::floating, 4, 32},
    {VK_FORMAT_R32G32B32A32_SFLOAT, Coding::floating, 4, 32},
    {VK_FORMAT_R16G16B16A16_SFLOAT, Coding::floating, 4, 16},
    {VK_FORMAT_R32_SFLOAT, Coding::floating, 1, 32},
    {VK_FORMAT_R8G8B8A8_UNORM, Coding::unorm, 4, 8},
    {VK_FORMAT_R8G8B8A8_SNORM, Coding::snorm, 4, 8},
    {VK_FORMAT_R32G32_SFLOAT, Coding::floating, 2, 32},
    {VK_FORMAT_R16G16_SFLOAT, Coding::floating, 2, 16},
    {VK_FORMAT_B10G11R11_UFLOAT_PACK32, Coding::packed11, 3, 32},
    {VK_FORMAT_R16_SFLOAT, Coding::floating, 1, 16},
    {VK_FORMAT_R16G16B16A16_UNORM, Coding::unorm, 4, 16},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, Coding::packed10_unorm, 4, 32},
    {VK_FORMAT_R16G16_UNORM, Coding::unorm, 2, 16},
    {VK_FORMAT_R8G8_UNORM, Coding::unorm, 2, 8},
    {VK_FORMAT_R16_UNORM, Coding::unorm, 1, 16},
    {VK_FORMAT_R8_UNORM, Coding::unorm, 1, 8},
    {VK_FORMAT_R16G16B16A16_SNORM, Coding::snorm, 4, 16},
    {VK_FORMAT_R16G16_SNORM, Coding::snorm, 2, 16},
    {VK_FORMAT_R8G8_SNORM, Coding::snorm, 2, 8},
    {VK_FORMAT_R16_SNORM, Coding::snorm, 1, 16},
    {VK_FORMAT_R8_SNORM, Coding::snorm, 1, 8},
    {VK_FORMAT_R32G32B32A32_SINT, Coding::sint, 4, 32},
    {VK_FORMAT_R16G16B16A16_SINT, Coding::sint, 4, 16},
    {VK_FORMAT_R8G8B8A8_SINT, Coding::sint, 4, 8},
    {VK_FORMAT_R32_SINT, Coding::sint, 1, 32},
    {VK_FORMAT_R32G32_SINT, Coding::sint, 2, 32},
    {VK_FORMAT_R16G16_SINT, Coding::sint, 2, 16},
    {VK_FORMAT_R8G8_SINT, Coding::sint, 2, 8},
    {VK_FORMAT_R16_SINT, Coding::sint, 1, 16},
    {VK_FORMAT_R8_SINT, Coding::sint, 1, 8},
    {VK_FORMAT_R32G32B32A32_UINT, Coding::uint, 4, 32},
    {VK_FORMAT_R16G16B16A16_UINT, Coding::uint, 4, 16},
    {VK_FORMAT_R8G8B8A8_UINT, Coding::uint, 4, 8},
    {VK_FORMAT_R32_UINT, Coding::uint, 1, 32},
    {VK_FORMAT_A2B10G10R10_UINT_PACK32, Coding::packed10_uint, 4, 32},
    {VK_FORMAT_R32G32_UINT, Coding::uint, 2, 32},
    {VK_FORMAT_R16G16_UINT, Coding::uint, 2, 16},
    {VK_FORMAT_R8G8_UINT, Coding::uint, 2, 8},
    {VK_FORMAT_R16_UINT, Coding::uint, 1, 16},
    {VK_FORMAT_R8_UINT, Coding::uint, 1, 8},
};

// Indexed by TexelFormat.
constexpr VkFormat encoded_formats[] = {
    VK_FORMAT_UNDEFINED,
    VK_FORMAT_R8G8B8A8_UNORM,
    VK_FORMAT_R8G8B8A8_SRGB,
    VK_FORMAT_R8_UNORM,
    VK_FORMAT_R8G8_UNORM,
    VK_FORMAT_R16_UNORM,
    VK_FORMAT_R16G16_UNORM,
    VK_FORMAT_R16G16B16A16_UNORM,
    VK_FORMAT_R16_SFLOAT,
    VK_FORMAT_R16G16_SFLOAT,
    VK_FORMAT_R16G16B16A16_SFLOAT,
    VK_FORMAT_R32_SFLOAT,
    VK_FORMAT_R32G32_SFLOAT,
    VK_FORMAT_R32G32B32A32_SFLOAT,
    VK_FORMAT_A2B10G10R10_UNORM_PACK32,
    VK_FORMAT_B10G11R11_UFLOAT_PACK32,
    VK_FORMAT_E5B9G9R9_UFLOAT_PACK32,
    VK_FORMAT_BC1_RGB_UNORM_BLOCK,
    VK_FORMAT_BC1_RGB_SRGB_BLOCK,
    VK_FORMAT_BC3_UNORM_BLOCK,
    VK_FORMAT_BC3_SRGB_BLOCK,
    VK_FORMAT_BC4_UNORM_BLOCK,
    VK_FORMAT_BC5_UNORM_BLOCK,
    VK_FORMAT_BC6H_UFLOAT_BLOCK,
    VK_FORMAT_BC7_UNORM_BLOCK,
    VK_FORMAT_BC7_SRGB_BLOCK,
    VK_FORMAT_D16_UNORM,
    VK_FORMAT_D32_SFLOAT,
};
static_assert(std::size(encoded_formats) == static_cast<size_t>(TexelFormat::d32_float) + 1);

float as_float(uint32_t bits) {
    float v;
    std::memcpy(&v, &bits, 4);
    return v;
}

uint32_t as_bits(float v) {
    uint32_t bits;
    std::memcpy(&bits, &v, 4);
    return bits;
}

uint32_t to_half(float v) {
    const uint32_t bits = as_bits(v), sign = bits >> 16 & 0x8000u;
    const float magnitude = std::fabs(v);
    if (!(magnitude < 65520.0f)) return sign | (std::isnan(v) ? 0x7e00u : 0x7c00u);
    if (magnitude < 0x1p-14f) return sign | static_cast<uint32_t>(std::lrint(magnitude * 0x1p24f));
    const uint32_t rounded = (bits & 0x7fffffffu) + 0xfffu + (bits >> 13 & 1u);
    return sign | ((rounded >> 13) - (112u << 10));
}

float from_half(uint32_t h) {
    const uint32_t exponent = h >> 10 & 31u, mantissa = h & 0x3ffu;
    float v;
    if (exponent == 0)
        v = static_cast<float>(mantissa) * 0x1p-24f;
    else if (exponent == 31)
        v = as_float(0x7f800000u | mantissa << 13);
    else
        v = as_float((exponent + 112u) << 23 | mantissa << 13);
    return (h & 0x8000u) != 0 ? -v : v;
}

uint32_t to_unorm(float v, uint32_t bits) {
    return static_cast<uint32_t>(std::lrint(std::clamp(v, 0.0f, 1.0f) * static_cast<float>((1u << bits) - 1)));
}

uint32_t encode(const Format& f, uint32_t word) {
    const uint32_t mask = f.bits == 32 ? ~0u : (1u << f.bits) - 1;
    switch (f.coding) {
        case Coding::floating:
            return f.bits == 16 ? to_half(as_float(word)) : word;
        case Coding::unorm:
            return to_unorm(as_float(word), f.bits);
        case Coding::snorm: {
            const float reach = static_cast<float>((1u << (f.bits - 1)) - 1);
            return static_cast<uint32_t>(std::lrint(std::clamp(as_float(word), -1.0f, 1.0f) * reach)) & mask;
        }
        default:
            return word & mask;
    }
}

uint32_t decode(const Format& f, uint32_t code) {
    switch (f.coding) {
        case Coding::floating:
            return f.bits == 16 ? as_bits(from_half(code)) : code;
        case Coding::unorm:
            return as_bits(static_cast<float>(code) / static_cast<float>((1u << f.bits) - 1));
        case Coding::sint:
        case Coding::snorm: {
            const uint32_t shift = 32 - f.bits;
            const int32_t v = static_cast<int32_t>(code << shift) >> shift;
            if (f.coding == Coding::sint) return static_cast<uint32_t>(v);
            return as_bits(std::max(-1.0f, static_cast<float>(v) / static_cast<float>((1u << (f.bits - 1)) - 1)));
        }
        default:
            return code;
    }
}

uint32_t pack_word(const Format& f, const uint32_t* c) {
    if (f.coding == Coding::packed11)
        return (to_half(std::max(0.0f, as_float(c[0]))) >> 4) | (to_half(std::max(0.0f, as_float(c[1]))) >> 4) << 11 |
               (to_half(std::max(0.0f, as_float(c[2]))) >> 5) << 22;
    if (f.coding == Coding::packed10_uint)
        return (c[0] & 1023u) | (c[1] & 1023u) << 10 | (c[2] & 1023u) << 20 | (c[3] & 3u) << 30;
    return to_unorm(as_float(c[0]), 10) | to_unorm(as_float(c[1]), 10) << 10 | to_unorm(as_float(c[2]), 10) << 20 |
           to_unorm(as_float(c[3]), 2) << 30;
}

void unpack_word(const Format& f, uint32_t w, std::vector<uint32_t>& out) {
    if (f.coding == Coding::packed11) {
        out.insert(out.end(), {as_bits(from_half((w & 2047u) << 4)), as_bits(from_half((w >> 11 & 2047u) << 4)),
                               as_bits(from_half((w >> 22) << 5))});
        return;
    }
    const uint32_t c[4] = {w & 1023u, w >> 10 & 1023u, w >> 20 & 1023u, w >> 30};
    for (unsigned i = 0; i < 4; ++i)
        out.push_back(f.coding == Coding::packed10_uint ? c[i] : as_bits(static_cast<float>(c[i]) / (i == 3 ? 3.0f : 1023.0f)));
}

bool is_packed(const Format& f) {
    return f.coding == Coding::packed11 || f.coding == Coding::packed10_unorm || f.coding == Coding::packed10_uint;
}

}  // namespace

BaseType Format::base() const {
    if (coding == Coding::sint) return BaseType::int32;
    return coding == Coding::uint || coding == Coding::packed10_uint ? BaseType::uint32 : BaseType::float32;
}

Format format_of(uint32_t spirv_format, BaseType base) {
    if (spirv_format != 0 && spirv_format < std::size(formats)) return formats[spirv_format];
    if (base == BaseType::int32) return formats[21];
    return base == BaseType::uint32 ? formats[30] : formats[1];
}

Format depth_format() { return {VK_FORMAT_D32_SFLOAT, Coding::depth, 1, 32}; }

Format format_of(const ImageData& image) {
    if (image.format == TexelFormat::standard) return image.depth ? depth_format() : format_of(0, image.base);
    Format out;
    const size_t i = static_cast<size_t>(image.format);
    out.vk = i < std::size(encoded_formats) ? encoded_formats[i] : VK_FORMAT_UNDEFINED;
    if (image.format == TexelFormat::d16_unorm || image.format == TexelFormat::d32_float) out.coding = Coding::depth;
    return out;
}

Bytes pack_texels(const Format& f, ByteView words) {
    if (f.coding == Coding::depth || (f.bits == 32 && f.components == 4 && !is_packed(f))) return {words.begin(), words.end()};
    Bytes out;
    for (size_t at = 0; at + 16 <= words.size(); at += 16) {
        uint32_t c[4];
        std::memcpy(c, words.data() + at, 16);
        const auto append = [&](uint32_t code, uint32_t bytes) {
            for (uint32_t i = 0; i < bytes; ++i) out.push_back(static_cast<uint8_t>(code >> (8 * i)));
        };
        if (is_packed(f))
            append(pack_word(f, c), 4);
        else
            for (uint32_t i = 0; i < f.components; ++i) append(encode(f, c[i]), f.bits / 8);
    }
    return out;
}

std::vector<uint32_t> unpack_texels(const Format& f, ByteView texels) {
    std::vector<uint32_t> out;
    const uint32_t step = is_packed(f) ? 4 : f.bits / 8;
    for (size_t at = 0; at + step <= texels.size(); at += step) {
        uint32_t code = 0;
        for (uint32_t i = 0; i < step; ++i) code |= uint32_t{texels[at + i]} << (8 * i);
        if (is_packed(f))
            unpack_word(f, code, out);
        else
            out.push_back(decode(f, code));
    }
    return out;
}

VkFormat vertex_format(BaseType base, uint32_t components) {
    constexpr VkFormat floats[] = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT,
                                   VK_FORMAT_R32G32B32A32_SFLOAT};
    constexpr VkFormat doubles[] = {VK_FORMAT_R64_SFLOAT, VK_FORMAT_R64G64_SFLOAT, VK_FORMAT_R64G64B64_SFLOAT,
                                    VK_FORMAT_R64G64B64A64_SFLOAT};
    constexpr VkFormat ints[] = {VK_FORMAT_R32_SINT, VK_FORMAT_R32G32_SINT, VK_FORMAT_R32G32B32_SINT,
                                 VK_FORMAT_R32G32B32A32_SINT};
    constexpr VkFormat uints[] = {VK_FORMAT_R32_UINT, VK_FORMAT_R32G32_UINT, VK_FORMAT_R32G32B32_UINT,
                                  VK_FORMAT_R32G32B32A32_UINT};
    const uint32_t i = std::clamp(components, 1u, 4u) - 1;
    switch (base) {
        case BaseType::float64:
            return doubles[i];
        case BaseType::int32:
        case BaseType::int16:
        case BaseType::int8:
            return ints[i];
        case BaseType::uint32:
        case BaseType::uint16:
        case BaseType::uint8:
            return uints[i];
        default:
            return floats[i];
    }
}

}  // namespace kiln
