#pragma once
// Small compute runs that look at one texture.

#include "compiler/device/compute.h"
#include "tests/device/glsl.h"

namespace kiln::test {

using Texel = std::array<float, 4>;

inline ComputeResult run_clean(const std::string& text, const ComputeData& data) {
    const Result<StageCode> stage = compute_stage("#version 450\n" + text);
    EXPECT_TRUE(stage.ok()) << (stage.ok() ? "" : stage.error().message);
    if (!stage.ok()) return {};
    Result<ComputeResult> out = run_compute(device(), *stage, data);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? std::move(*out) : ComputeResult();
}

inline std::shared_ptr<ImageData> image_of(TexelFormat format, uint32_t width, uint32_t height, Bytes texels, uint32_t mips = 1) {
    auto out = std::make_shared<ImageData>();
    out->format = format;
    out->width = width;
    out->height = height;
    out->mips = mips;
    out->texels = std::move(texels);
    return out;
}

// One result for each of `at`, from `expression` over a sampler t of `type`, with `at` the vec4 p.
inline std::vector<Texel> look(const std::string& type, const std::string& expression, const std::vector<Texel>& at,
                               std::shared_ptr<const ImageData> image, std::optional<SamplerState> sampler = {}) {
    const std::string text = "layout(local_size_x = 1) in;\nlayout(set = 0, binding = 0) uniform " + type +
                             " t;\nlayout(set = 0, binding = 1) readonly buffer In { vec4 at[]; };\n"
                             "layout(set = 0, binding = 2) buffer Out { vec4 seen[]; };\n"
                             "void main() { uint i = gl_GlobalInvocationID.x; vec4 p = at[i]; seen[i] = vec4(" +
                             expression + "); }\n";
    ComputeData data;
    data.buffers = {{"In", bytes_of(at)}, {"Out", Bytes(at.size() * sizeof(Texel))}};
    data.images = {{"t", std::move(image), sampler}};
    data.groups[0] = static_cast<uint32_t>(at.size());
    std::vector<Texel> out = values_of<Texel>(run_clean(text, data).buffer("Out"));
    out.resize(at.size());
    return out;
}

// Every texel of mip `mip` of a 2D image, row by row.
inline std::vector<Texel> fetch_all(std::shared_ptr<const ImageData> image, uint32_t mip = 0) {
    std::vector<Texel> at;
    for (uint32_t y = 0; y < std::max(1u, image->height >> mip); ++y)
        for (uint32_t x = 0; x < std::max(1u, image->width >> mip); ++x)
            at.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(mip), 0.0f});
    const SamplerState nearest{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off};  // others refuse depth
    return look("sampler2D", "texelFetch(t, ivec2(p.xy), int(p.z))", at, std::move(image), nearest);
}

template <class T>
Bytes little(std::initializer_list<T> values) {
    return bytes_of(std::vector<T>(values));
}

}  // namespace kiln::test
