// Uniform blocks where lavapipe miscounts them (compiler/device/spare.h).

#include "compiler/device/spare.h"

#include <cstring>

#include "tests/device/glsl.h"

namespace kiln::test {
namespace {

constexpr uint32_t a = 1, b = 16;  // stages

TEST(SpareDescriptors, NoBlockStandsFourth) {
    const auto spare = [](const std::vector<UniformUse>& uses) { return spare_descriptors(uses, 15); };
    using Spare = std::vector<uint32_t>;
    EXPECT_EQ(spare({}), Spare());
    EXPECT_EQ(spare({{1, a}, {1, a}, {1, a}}), Spare({0, 0, 0}));
    EXPECT_EQ(spare({{1, a}, {1, a}, {1, a}, {1, a}, {1, a}}), Spare({0, 0, 1, 0, 0}));
    EXPECT_EQ(spare({{1, a}, {1, b}, {1, a}, {1, b}, {1, a}, {1, b}}), Spare({0, 0, 0, 0, 0, 0}));
    // What moves a block of the one stage on moves one of the other to where the first was.
    EXPECT_EQ(spare({{1, a}, {1, a | b}, {1, a | b}, {1, b}, {1, b}, {1, a}}), Spare({0, 0, 2, 0, 0, 0}));
    EXPECT_EQ(spare({{1, a}, {2, a}, {1, b}, {3, a}}), Spare({0, 1, 0, 0}));
    EXPECT_EQ(spare({{1, a}, {8, a}}), Spare({3, 0})) << "an array that reaches over the fourth place begins behind it";
    EXPECT_EQ(spare({{8, a}}), Spare({0})) << "nothing to move it with";
    EXPECT_EQ(spare_descriptors({{1, a}, {1, a}, {1, a}, {1, a}}, 4), Spare({0, 0, 0, 0})) << "no more than the device has";
}

// A shader of more than a hundred operations with a branch on a uniform of the last of `count` blocks against what is none.
PipelineRequest with_blocks(int count, bool read_all) {
    std::string text, sum = "0.0";
    for (int i = 0; i < count; ++i) {
        const std::string n = std::to_string(i);
        text += "layout(std140, set = " + std::to_string(i / 3) + ", binding = " + n + ") uniform B" + n + " { vec4 x" + n +
                ", y" + n + "; };\n";
        if (read_all) sum += " + x" + n + ".y";
    }
    const std::string last = std::to_string(count - 1);
    text += "layout(location = 0) out vec4 c;\nvoid main() {\n    vec4 p = gl_FragCoord;\n";
    for (int i = 0; i < 40; ++i) text += "    p = p * 0.5 + fract(p.wzyx);\n";
    text += "    if (y" + last + ".z < gl_FragCoord.x) { for (int i = 0; i < 3; ++i) p = sin(p) * 2.0; }\n    c = vec4(" + sum +
            ", x" + last + ".x, y" + last + ".z, p.x);\n}\n";
    PipelineRequest request;
    request.stages = {plain_vertex(), fragment(text)};
    request.inputs = {make_inputs(request.stages, InputOptions())};
    request.size = 16;
    return request;
}

float number(const Bytes& from, size_t at) {
    float out;
    std::memcpy(&out, from.data() + at, 4);
    return out;
}

TEST(SpareDescriptors, AnyNumberOfBlocksIsDrawn) {
    for (const bool read_all : {true, false})
        for (int count = 1; count <= 9; ++count) {
            const PipelineRequest request = with_blocks(count, read_all);
            Result<PipelineOutput> out = device().run(request);
            ASSERT_TRUE(out.ok());
            ASSERT_TRUE(out->errors.empty()) << out->errors.front();
            ASSERT_EQ(out->runs.size(), 1u);
            ASSERT_GT(out->runs[0].covered, 0u);
            float sum = 0;
            const std::vector<Binding>& bindings = request.inputs[0].bindings;
            ASSERT_EQ(bindings.size(), static_cast<size_t>(count));
            for (const Binding& block : bindings) sum += read_all ? number(block.buffers[0], 4) : 0;
            const ReadBack& colour = out->runs[0].values[0];
            size_t right = 0;
            for (size_t i = 0; i + 3 < colour.words.size(); i += 4) {
                float rgb[3];
                std::memcpy(rgb, colour.words.data() + i, 12);
                right += std::abs(rgb[0] - sum) < 1e-3 && rgb[1] == number(bindings.back().buffers[0], 0) &&
                         rgb[2] == number(bindings.back().buffers[0], 24);
            }
            EXPECT_EQ(right, out->runs[0].covered) << count << " blocks";
        }
}

}  // namespace
}  // namespace kiln::test
