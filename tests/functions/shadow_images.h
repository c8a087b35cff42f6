#pragma once
// Expressions over several textures, evaluated on the device at given points.

#include "tests/device/fetch.h"
#include "tests/device/uber_text.h"
#include "tests/functions/shadow_maps.h"

namespace kiln::test {

struct Sampled {
    std::string declaration;  // "sampler2DShadow map"
    std::shared_ptr<const ImageData> image;
    SamplerState sampler;
};

// `expression` (a float to a vec4) for each vec4 p of `at`. text: what stands before main, such as included files.
std::vector<Texel> evaluate(const std::string& text, const std::string& expression, const std::vector<Texel>& at,
                            const std::vector<Sampled>& textures = {});

// A summed-area table of a square map of moments, or its mip chain, made by uber/moments.comp. Pairs, row after row.
std::vector<float> table_by_device(const std::vector<float>& pairs, uint32_t width, uint32_t height);
std::vector<float> half_by_device(const std::vector<float>& pairs, uint32_t width, uint32_t height);
// A square map and all of its mips down to one texel.
std::vector<float> mips_by_device(const std::vector<float>& pairs, uint32_t size);

}  // namespace kiln::test
