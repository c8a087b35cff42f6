#include "compiler/validate/textures.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>

#include "compiler/validate/values.h"

namespace kiln {

namespace {

constexpr uint32_t texture_size = 16;
constexpr size_t kept_images = 256;

// A smooth periodic wave with a little noise: neighbours differ, and so do components, layers and mips.
float texel(uint64_t seed, const ImageData& image, uint32_t mip, uint32_t layer, uint32_t x, uint32_t y, uint32_t z, uint32_t c) {
    const float scale = static_cast<float>(1u << mip) / static_cast<float>(texture_size);
    const float u = (static_cast<float>(x) + 0.5f) * scale, v = (static_cast<float>(y) + 0.5f) * scale;
    const uint64_t of_layer = mix64(seed ^ ((uint64_t{layer} * 64 + z) * 8 + c));
    const float phase = 6.2831853f * unit(of_layer, 1);
    const float turns_u = 1.0f + std::floor(2.0f * unit(of_layer, 2)), turns_v = 1.0f + std::floor(2.0f * unit(of_layer, 3));
    const float wave = std::sin(6.2831853f * (turns_u * u + turns_v * v) + phase);
    const float noise = unit(of_layer, 16 + (uint64_t{mip} << 32 | uint64_t{y} << 16 | x)) - 0.5f;
    return (image.depth ? 0.5f : 0.55f) + 0.35f * wave + 0.18f * noise;
}

void put_word(Bytes& out, uint32_t word) {
    const size_t at = out.size();
    out.resize(at + 4);
    std::memcpy(out.data() + at, &word, 4);
}

void put_texel(Bytes& out, uint64_t seed, const ImageData& image, bool either_sign, uint32_t mip, uint32_t layer, uint32_t x,
               uint32_t y, uint32_t z) {
    for (uint32_t c = 0; c < (image.depth ? 1u : 4u); ++c) {
        float v = texel(seed, image, mip, layer, x, y, z, c);
        if (image.base != BaseType::float32) {
            put_word(out, static_cast<uint32_t>(v * 4.0f) & 3u);
            continue;
        }
        if (either_sign && !image.depth) v = 2.0f * (v - 0.55f);
        uint32_t bits;
        std::memcpy(&bits, &v, 4);
        put_word(out, bits);
    }
}

}  // namespace

std::shared_ptr<const ImageData> make_image(const Resource& resource, uint64_t seed, bool either_sign) {
    auto image = std::make_shared<ImageData>();
    const bool storage = resource.kind == ResourceKind::storage_image;
    image->dim = resource.dim == ImageDim::none || resource.dim == ImageDim::rect ? ImageDim::d2 : resource.dim;
    image->arrayed = resource.arrayed;
    image->multisampled = resource.multisampled;
    image->depth = resource.depth && !storage;
    image->base =
        resource.sampled == BaseType::int32 || resource.sampled == BaseType::uint32 ? resource.sampled : BaseType::float32;
    image->width = storage || image->dim == ImageDim::subpass ? 64 : texture_size;
    image->height = image->dim == ImageDim::d1 ? 1 : image->width;
    image->slices = image->dim == ImageDim::d3 ? 4 : 1;
    image->layers = (image->dim == ImageDim::cube ? 6u : 1u) * (image->arrayed ? (image->dim == ImageDim::cube ? 2u : 3u) : 1u);
    if (!storage && !image->multisampled && image->dim != ImageDim::subpass)
        while (image->width >> image->mips != 0) ++image->mips;

    static std::mutex mutex;
    using Key = std::tuple<uint64_t, bool, ImageDim, bool, bool, bool, BaseType, uint32_t>;
    static std::map<Key, std::shared_ptr<const ImageData>> kept;
    const Key key{seed, either_sign, image->dim, image->arrayed, image->multisampled, image->depth, image->base, image->width};
    const std::lock_guard lock(mutex);
    if (const auto found = kept.find(key); found != kept.end()) return found->second;
    if (kept.size() >= kept_images) kept.clear();

    for (uint32_t mip = 0; mip < image->mips; ++mip)
        for (uint32_t layer = 0; layer < image->layers; ++layer)
            for (uint32_t z = 0; z < std::max(1u, image->slices >> mip); ++z)
                for (uint32_t y = 0; y < std::max(1u, image->height >> mip); ++y)
                    for (uint32_t x = 0; x < std::max(1u, image->width >> mip); ++x)
                        put_texel(image->texels, seed, *image, either_sign, mip, layer, x, y, z);
    kept[key] = image;
    return image;
}

}  // namespace kiln
