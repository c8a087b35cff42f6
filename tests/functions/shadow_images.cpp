#include "tests/functions/shadow_images.h"

namespace kiln::test {

std::vector<Texel> evaluate(const std::string& text, const std::string& expression, const std::vector<Texel>& at,
                            const std::vector<Sampled>& textures) {
    std::string glsl = text +
                       "layout(local_size_x = 64) in;\nlayout(set = 0, binding = 0) readonly buffer In { vec4 at[]; };\n"
                       "layout(set = 0, binding = 1) buffer Out { vec4 seen[]; };\n";
    ComputeData data;
    data.buffers = {{"In", bytes_of(at)}, {"Out", Bytes(at.size() * sizeof(Texel))}};
    for (size_t i = 0; i < textures.size(); ++i) {
        const std::string& declaration = textures[i].declaration;
        glsl += "layout(set = 0, binding = " + std::to_string(2 + i) + ") uniform " + declaration + ";\n";
        data.images.push_back({declaration.substr(declaration.find(' ') + 1), textures[i].image, textures[i].sampler});
    }
    glsl +=
        "void main() {\n    uint i = gl_GlobalInvocationID.x;\n    if (i >= uint(at.length())) return;\n    vec4 p = at[i];\n"
        "    seen[i] = vec4(" +
        expression + ");\n}\n";
    data.groups[0] = static_cast<uint32_t>((at.size() + 63) / 64);
    std::vector<Texel> out = values_of<Texel>(run_clean(glsl, data).buffer("Out"));
    EXPECT_EQ(out.size(), at.size());
    out.resize(at.size());
    return out;
}

namespace {

// One pass of moments.comp over storage images of 4 floats a texel.
std::vector<float> pass(int operation, const std::vector<float>& pairs, uint32_t width, uint32_t height, uint32_t to_width,
                        uint32_t to_height, std::array<uint32_t, 3> groups) {
    const auto image = [](uint32_t w, uint32_t h, const std::vector<float>& from) {
        std::vector<float> texels(size_t{w} * h * 4);
        for (size_t i = 0; 2 * i + 1 < from.size(); ++i) texels[4 * i] = from[2 * i], texels[4 * i + 1] = from[2 * i + 1];
        return image_of(TexelFormat::standard, w, h, bytes_of(texels));
    };
    const std::string text = uber_text("moments.comp", "#define OPERATION " + std::to_string(operation) + "\n");
    ComputeData data;
    data.images = {{"source", image(width, height, pairs), {}}, {"target", image(to_width, to_height, {}), {}}};
    data.groups = groups;
    const ComputeResult result = run_clean(text.substr(text.find('\n') + 1), data);
    const ReadBack* target = result.image("target");
    EXPECT_NE(target, nullptr);
    std::vector<float> out(size_t{to_width} * to_height * 2);
    if (!target || target->components < 2) return out;
    for (size_t i = 0; i < size_t{to_width} * to_height; ++i)
        for (size_t c = 0; c < 2; ++c) out[2 * i + c] = std::bit_cast<float>(target->words.at(i * target->components + c));
    return out;
}

}  // namespace

std::vector<float> table_by_device(const std::vector<float>& pairs, uint32_t width, uint32_t height) {
    return pass(1, pass(0, pairs, width, height, width, height, {height, 1, 1}), width, height, width, height, {width, 1, 1});
}

std::vector<float> half_by_device(const std::vector<float>& pairs, uint32_t width, uint32_t height) {
    const uint32_t w = std::max(width / 2, 1u), h = std::max(height / 2, 1u);
    return pass(2, pairs, width, height, w, h, {(w + 7) / 8, (h + 7) / 8, 1});
}

std::vector<float> mips_by_device(const std::vector<float>& pairs, uint32_t size) {
    std::vector<float> chain = pairs, level = pairs;
    for (uint32_t side = size; side > 1; side /= 2) {
        level = half_by_device(level, side, side);
        chain.insert(chain.end(), level.begin(), level.end());
    }
    return chain;
}

}  // namespace kiln::test
