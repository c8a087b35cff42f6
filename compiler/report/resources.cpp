#include "compiler/report/resources.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "uber/reference/color.h"

namespace kiln::report {

namespace {

void put(Bytes& out, uint32_t word, size_t bytes) {
    for (size_t i = 0; i < bytes; ++i) out.push_back(static_cast<uint8_t>(word >> (8 * i)));
}

// An unsigned float of 5 exponent bits and `mantissa` mantissa bits, by truncating the half after rounding at the new place.
uint32_t small_float(float value, uint32_t mantissa) {
    if (!(value > 0.0f)) return 0;
    const uint32_t most = (31u << mantissa) - 1;  // the largest finite one
    const double limit = std::ldexp(2.0 - std::ldexp(1.0, -static_cast<int>(mantissa)), 15);
    if (static_cast<double>(value) >= limit) return most;
    int exponent = 0;
    std::frexp(value, &exponent);
    exponent = std::max(exponent - 1, -14);
    const double steps = std::nearbyint(std::ldexp(static_cast<double>(value), static_cast<int>(mantissa) - exponent));
    const uint32_t whole = static_cast<uint32_t>(steps);
    const uint32_t one = 1u << mantissa;
    // A carry out of the mantissa lands in the exponent by itself.
    return whole < one ? whole : ((static_cast<uint32_t>(exponent + 15) << mantissa) + (whole - one));
}

uint32_t shared_exponent(const float* c) {  // EXT_texture_shared_exponent
    constexpr double largest = 65408.0;
    double v[3], most = 0.0;
    for (size_t i = 0; i < 3; ++i) {
        v[i] = std::clamp(static_cast<double>(c[i]), 0.0, largest);
        most = std::max(most, v[i]);
    }
    int exponent = most == 0.0 ? -16 : std::max(-16, std::ilogb(most)) + 1 + 15;
    if (most == 0.0) exponent = 0;
    if (std::nearbyint(std::ldexp(most, 9 + 15 - exponent)) == 512.0) ++exponent;
    uint32_t out = static_cast<uint32_t>(exponent) << 27;
    for (size_t i = 0; i < 3; ++i) out |= static_cast<uint32_t>(std::nearbyint(std::ldexp(v[i], 9 + 15 - exponent))) << (9 * i);
    return out;
}

uint32_t unorm(float value, uint32_t bits) {
    const double most = static_cast<double>((1u << bits) - 1);
    return static_cast<uint32_t>(std::nearbyint(std::clamp(static_cast<double>(value), 0.0, 1.0) * most));
}

Resource image_of(const std::string& declaration, ImageData image, const SamplerState& sampler) {
    Resource r;
    r.declaration = declaration;
    r.bytes = image.texels.size();
    r.binding.kind = ResourceKind::combined_image;
    r.binding.name = declaration;
    r.binding.compare = sampler.compare != Comparison::off;
    r.binding.sampler = sampler;
    r.binding.images.push_back(std::make_shared<const ImageData>(std::move(image)));
    return r;
}

}  // namespace

uint16_t half_of(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value), sign = bits >> 16 & 0x8000u, size = bits & 0x7fffffffu;
    constexpr uint32_t infinity = 0x7f800000u, least_too_large = 0x477ff000u, least_normal = 0x38800000u;  // 65520, 2^-14
    if (size > infinity) return static_cast<uint16_t>(sign | 0x7e00u);
    if (size >= least_too_large) return static_cast<uint16_t>(sign | 0x7c00u);
    // Below 2^-14 steps are 2^-24, a float's between 0.5 and 1, so that the addition rounds.
    if (size < least_normal)
        return static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(std::bit_cast<float>(size) + 0.5f) - 0x3f000000u));
    return static_cast<uint16_t>(sign | ((size + 0xfffu + (size >> 13 & 1u) - (112u << 23)) >> 13));
}

float float_of_half(uint16_t half) {
    const uint32_t exponent = half >> 10 & 31u, mantissa = half & 1023u;
    double size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024.0 + mantissa, static_cast<int>(exponent) - 25);
    if (exponent == 31) size = mantissa == 0 ? HUGE_VAL : NAN;
    return static_cast<float>((half & 0x8000u) != 0 ? -size : size);
}

uint32_t components_of(TexelFormat format) {
    switch (format) {
        case TexelFormat::r16_float:
        case TexelFormat::r32_float:
        case TexelFormat::r8_unorm:
        case TexelFormat::d32_float:
            return 1;
        case TexelFormat::rg16_float:
        case TexelFormat::rg32_float:
            return 2;
        default:
            return 4;
    }
}

Bytes encode_texels(TexelFormat format, const std::vector<float>& c) {
    Bytes out;
    [[maybe_unused]] const size_t n = components_of(format);
    assert(c.size() % n == 0);
    switch (format) {
        case TexelFormat::r32_float:
        case TexelFormat::rg32_float:
        case TexelFormat::rgba32_float:
        case TexelFormat::d32_float:
            out.resize(c.size() * 4);
            if (!c.empty()) std::memcpy(out.data(), c.data(), out.size());
            break;
        case TexelFormat::r16_float:
        case TexelFormat::rg16_float:
        case TexelFormat::rgba16_float:
            for (const float v : c) put(out, half_of(v), 2);
            break;
        case TexelFormat::r8_unorm:
        case TexelFormat::rgba8_unorm:
            for (const float v : c) put(out, unorm(v, 8), 1);
            break;
        case TexelFormat::rgba8_srgb:
            for (size_t i = 0; i < c.size(); ++i)
                put(out, unorm(i % 4 == 3 ? c[i] : static_cast<float>(reference::srgb_encode(static_cast<double>(c[i]))), 8), 1);
            break;
        case TexelFormat::rgb10a2_unorm:
            for (size_t i = 0; i < c.size(); i += 4)
                put(out, unorm(c[i], 10) | unorm(c[i + 1], 10) << 10 | unorm(c[i + 2], 10) << 20 | unorm(c[i + 3], 2) << 30, 4);
            break;
        case TexelFormat::rg11b10_float:
            for (size_t i = 0; i < c.size(); i += 4)
                put(out, small_float(c[i], 6) | small_float(c[i + 1], 6) << 11 | small_float(c[i + 2], 5) << 22, 4);
            break;
        case TexelFormat::rgb9e5_float:
            for (size_t i = 0; i < c.size(); i += 4) put(out, shared_exponent(&c[i]), 4);
            break;
        default:
            assert(false);
            break;
    }
    return out;
}

Resource storage_buffer(const std::string& declaration, const std::vector<float>& values) {
    Resource r;
    r.declaration = declaration;
    r.bytes = values.size() * 4;
    r.binding.kind = ResourceKind::storage_block;
    r.binding.name = declaration;
    r.binding.types.assign(1, BaseType::float32);
    Bytes bytes(values.size() * 4);
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    r.binding.buffers.push_back(std::move(bytes));
    return r;
}

Resource uniform_buffer(const std::string& declaration, const std::vector<float>& values) {
    Resource r = storage_buffer(declaration, values);
    r.binding.kind = ResourceKind::uniform_block;
    return r;
}

Resource cube_map(const std::string& name, TexelFormat format, uint32_t size, const std::vector<std::vector<float>>& mips) {
    ImageData image;
    image.dim = ImageDim::cube;
    image.format = format;
    image.width = image.height = size;
    image.layers = 6;
    image.mips = static_cast<uint32_t>(mips.size());
    for (const std::vector<float>& mip : mips) {
        const Bytes bytes = encode_texels(format, mip);
        image.texels.insert(image.texels.end(), bytes.begin(), bytes.end());
    }
    SamplerState sampler;
    sampler.wrap = Wrap::clamp;
    sampler.mips = mips.size() > 1 ? MipFilter::linear : MipFilter::none;
    return image_of("uniform samplerCube " + name, std::move(image), sampler);
}

Resource picture_map(const std::string& name, TexelFormat format, uint32_t width, uint32_t height,
                     const std::vector<std::vector<float>>& mips, SamplerState sampler) {
    ImageData image;
    image.format = format;
    image.width = width;
    image.height = height;
    image.mips = static_cast<uint32_t>(mips.size());
    for (const std::vector<float>& mip : mips) {
        const Bytes bytes = encode_texels(format, mip);
        image.texels.insert(image.texels.end(), bytes.begin(), bytes.end());
    }
    return image_of("uniform sampler2D " + name, std::move(image), sampler);
}

Resource block_map(const std::string& name, TexelFormat format, uint32_t width, uint32_t height, Bytes blocks,
                   const SamplerState& sampler) {
    ImageData image;
    image.format = format;
    image.width = width;
    image.height = height;
    image.texels = std::move(blocks);
    return image_of("uniform sampler2D " + name, std::move(image), sampler);
}

Resource volume_map(const std::string& name, TexelFormat format, VolumeSize size, const std::vector<std::vector<float>>& mips) {
    ImageData image;
    image.dim = ImageDim::d3;
    image.format = format;
    image.width = size.width;
    image.height = size.height;
    image.slices = size.depth;
    image.mips = static_cast<uint32_t>(mips.size());
    for (const std::vector<float>& mip : mips) {
        const Bytes bytes = encode_texels(format, mip);
        image.texels.insert(image.texels.end(), bytes.begin(), bytes.end());
    }
    SamplerState sampler;
    sampler.wrap = Wrap::clamp;
    sampler.mips = mips.size() > 1 ? MipFilter::linear : MipFilter::none;
    return image_of("uniform sampler3D " + name, std::move(image), sampler);
}

Resource volume_map(const std::string& name, TexelFormat format, uint32_t side, const std::vector<std::vector<float>>& mips) {
    return volume_map(name, format, VolumeSize{side, side, side}, mips);
}

Resource depth_map(const std::string& name, uint32_t size, const std::vector<float>& depth, bool comparing, Filter filter) {
    ImageData image;
    image.format = comparing ? TexelFormat::d32_float : TexelFormat::r32_float;
    image.depth = comparing;
    image.width = image.height = size;
    image.texels = encode_texels(image.format, depth);
    SamplerState sampler;
    sampler.filter = filter;
    sampler.mips = MipFilter::none;
    sampler.wrap = Wrap::clamp;
    sampler.compare = comparing ? Comparison::less_or_equal : Comparison::off;
    return image_of(std::string(comparing ? "uniform sampler2DShadow " : "uniform sampler2D ") + name, std::move(image), sampler);
}

Resource depth_array(const std::string& name, uint32_t size, uint32_t layers, const std::vector<float>& depth, bool comparing) {
    ImageData image;
    image.format = comparing ? TexelFormat::d32_float : TexelFormat::r32_float;
    image.depth = comparing;
    image.arrayed = true;
    image.width = image.height = size;
    image.layers = layers;
    image.texels = encode_texels(image.format, depth);
    SamplerState sampler;
    sampler.filter = Filter::nearest;
    sampler.mips = MipFilter::none;
    sampler.wrap = Wrap::clamp;
    sampler.compare = comparing ? Comparison::less_or_equal : Comparison::off;
    return image_of(std::string(comparing ? "uniform sampler2DArrayShadow " : "uniform sampler2DArray ") + name, std::move(image),
                    sampler);
}

Vec3d cube_direction(uint32_t face, double x, double y) {
    switch (face) {
        case 0:
            return {1.0, -y, -x};
        case 1:
            return {-1.0, -y, x};
        case 2:
            return {x, 1.0, y};
        case 3:
            return {x, -1.0, -y};
        case 4:
            return {x, -y, 1.0};
        default:
            return {-x, -y, -1.0};
    }
}

}  // namespace kiln::report
