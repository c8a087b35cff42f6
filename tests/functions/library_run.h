#pragma once
// Whole loops over files of uber/lib in one compute run.

#include <fstream>
#include <set>

#include "tests/device/fetch.h"

namespace kiln::test {

// A file of uber/lib with what it includes, each once.
inline std::string library(const std::string& name, std::set<std::string>& seen) {
    if (!seen.insert(name).second) return {};
    std::ifstream file(std::string(KILN_SOURCE_DIR) + "/uber/lib/" + name);
    EXPECT_TRUE(file.good()) << name;
    std::string text;
    for (std::string line; std::getline(file, line);) {
        const std::string mark = "#include \"";
        if (line.rfind(mark, 0) == 0)
            text += library(line.substr(mark.size(), line.size() - mark.size() - 1), seen);
        else
            text += line + "\n";
    }
    return text;
}

// One vec4 an invocation from the statements of `body`, which read `i` and `count` and assign `result`.
inline std::vector<Texel> compute(const std::string& defines, const std::vector<std::string>& files, const std::string& body,
                                  uint32_t count, std::vector<NamedImage> images = {}, const std::string& samplers = {}) {
    std::set<std::string> seen;
    std::string text = defines + "layout(local_size_x = 1) in;\nlayout(set = 0, binding = 0) buffer Out { vec4 results[]; };\n";
    for (const std::string& file : files) text += library(file, seen);
    text += samplers +
            "void main() {\n    const int i = int(gl_GlobalInvocationID.x);\n    const int count = int(gl_NumWorkGroups.x);\n" +
            "    vec4 result = vec4(0.0);\n" + body + "    results[i] = result;\n}\n";
    ComputeData data;
    data.buffers = {{"Out", Bytes(count * sizeof(Texel))}};
    data.images = std::move(images);
    data.groups[0] = count;
    std::vector<Texel> out = values_of<Texel>(run_clean(text, data).buffer("Out"));
    out.resize(count);
    return out;
}

inline double at(const Texel& t, std::size_t component) { return static_cast<double>(t[component]); }

inline std::shared_ptr<ImageData> volume_of(TexelFormat format, uint32_t side, Bytes texels) {
    auto image = image_of(format, side, side, std::move(texels));
    image->dim = ImageDim::d3;
    image->slices = side;
    return image;
}

inline constexpr SamplerState smooth{Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::off};

}  // namespace kiln::test
