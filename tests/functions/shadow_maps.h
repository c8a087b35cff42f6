#pragma once
// Shadow maps of the scenes of shadow_truth.h, as textures and as what stands for them in references.

#include <cstring>
#include <memory>

#include "tests/functions/function.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::test {

template <class Number>
Bytes texels_of(const std::vector<Number>& values) {
    Bytes out(values.size() * sizeof(Number));
    std::memcpy(out.data(), values.data(), out.size());
    return out;
}

inline SamplerState nearest(bool compare) {
    return {Filter::nearest, MipFilter::none, Wrap::clamp, compare ? Comparison::less_or_equal : Comparison::off};
}

// A square D32F map, layer after layer.
struct DepthTexture {
    int size = 0;
    std::vector<float> depths;

    // compared: as a depth texture; else its numbers alone.
    std::shared_ptr<const ImageData> image(bool arrayed = false, bool compared = true) const {
        auto out = std::make_shared<ImageData>();
        out->format = compared ? TexelFormat::d32_float : TexelFormat::r32_float;
        out->depth = compared;
        out->width = out->height = static_cast<uint32_t>(size);
        out->arrayed = arrayed;
        out->layers = static_cast<uint32_t>(depths.size()) / (out->width * out->height);
        out->texels = texels_of(depths);
        return out;
    }

    // Nearest texel, clamped.
    template <class T>
    T read(const reference::Vec2<T>& uv, int layer = 0) const {
        const auto index = [&](const T& u) {
            return static_cast<size_t>(std::min(std::max(reference::value(floor(u * T(size))), 0.0), size - 1.0));
        };
        const size_t side = static_cast<size_t>(size);
        return T(static_cast<double>(depths[(static_cast<size_t>(layer) * side + index(uv.y)) * side + index(uv.x)]));
    }
    template <class T>
    T compare(const reference::Vec2<T>& uv, const T& depth, int layer = 0) const {
        return depth <= read(uv, layer) ? T(1) : T(0);
    }
};

inline DepthTexture depth_texture(const reference::ShadowScene& scene, const reference::LightView& view, int size) {
    DepthTexture out{size, {}};
    for (const double d : reference::distance_map(scene, view, size)) out.depths.push_back(static_cast<float>(view.depth(d)));
    return out;
}

// RG32F texels.
inline std::shared_ptr<const ImageData> moments_image(const std::vector<float>& pairs, uint32_t size, uint32_t mips = 1) {
    auto out = std::make_shared<ImageData>();
    out->format = TexelFormat::rg32_float;
    out->width = out->height = size;
    out->mips = mips;
    out->texels = texels_of(pairs);
    return out;
}

// Inclusive sums of a map of moments.
inline reference::MomentMap summed(const reference::MomentMap& map) {
    reference::MomentMap out = map;
    const size_t n = static_cast<size_t>(map.size);
    for (size_t y = 0; y < n; ++y)
        for (size_t x = 1; x < n; ++x) out.texels[y * n + x] = out.texels[y * n + x - 1] + out.texels[y * n + x];
    for (size_t y = 1; y < n; ++y)
        for (size_t x = 0; x < n; ++x) out.texels[y * n + x] = out.texels[(y - 1) * n + x] + out.texels[y * n + x];
    return out;
}

inline std::vector<float> floats_of(const reference::MomentMap& map) {
    std::vector<float> out;
    for (const auto& m : map.texels) out.insert(out.end(), {static_cast<float>(m.x), static_cast<float>(m.y)});
    return out;
}

}  // namespace kiln::test
