// The convenience for compute runs: names, sizes, shapes and what goes wrong with them.

#include "compiler/device/compute.h"

#include "tests/device/fetch.h"

namespace kiln::test {
namespace {

const std::string doubler = R"(#version 450
layout(local_size_x = 16) in;
layout(set = 0, binding = 0) readonly buffer In { float x[]; };
layout(set = 1, binding = 3) buffer Out { float y[]; };
layout(set = 0, binding = 2) uniform Scale { float scale; float unused; };
layout(set = 0, binding = 4) readonly buffer Idle { float idle[]; };
layout(push_constant) uniform Push { uint count; };
void main() { uint i = gl_GlobalInvocationID.x; if (i < count) y[i] = scale * x[i]; }
)";

ComputeData doubler_data(size_t n) {
    std::vector<float> xs;
    for (size_t i = 0; i < n; ++i) xs.push_back(static_cast<float>(i));
    ComputeData data;
    data.buffers = {{"In", bytes_of(xs)}, {"Out", Bytes(n * 4)}, {"Scale", little<float>({2, 0})}, {"Idle", Bytes(4)}};
    data.push_constants = little<uint32_t>({static_cast<uint32_t>(n)});
    return data;
}

TEST(Compute, BuffersByName) {
    for (const Optimise optimise : {Optimise::none, Optimise::performance, Optimise::size}) {
        const Result<StageCode> stage = compute_stage(doubler, optimise);
        ASSERT_TRUE(stage.ok()) << stage.error().message;
        EXPECT_EQ(group_count(*stage, 1), 1u);
        EXPECT_EQ(group_count(*stage, 16), 1u);
        EXPECT_EQ(group_count(*stage, 17), 2u);
        std::vector<ComputeData> runs = {doubler_data(100), doubler_data(3)};
        for (ComputeData& d : runs) d.groups[0] = group_count(*stage, 100);
        const auto out = run_compute(device(), *stage, runs);
        ASSERT_TRUE(out.ok()) << out.error().message;
        ASSERT_EQ(out->size(), 2u);
        const auto ys = values_of<float>((*out)[0].buffer("Out"));
        ASSERT_EQ(ys.size(), 100u);
        for (size_t i = 0; i < ys.size(); ++i) EXPECT_EQ(ys[i], 2.0f * static_cast<float>(i));
        EXPECT_EQ(values_of<float>((*out)[1].buffer("Out")), (std::vector<float>{0, 2, 4}));
        EXPECT_TRUE((*out)[0].buffer("In").empty()) << "what is readonly does not come back";
        EXPECT_EQ((*out)[0].image("Out"), nullptr);
    }
}

TEST(Compute, StorageImagesOfAnySizeAndArraysOfBuffers) {
    const std::string text = R"(
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, rgba16f) uniform image2DArray pictures;
layout(set = 0, binding = 1) buffer Parts { uint v; } parts[3];
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    imageStore(pictures, at, vec4(at, 0.5) + imageLoad(pictures, at));
    if (at == ivec3(0)) { parts[0].v += 1u; parts[1].v += 2u; parts[2].v += 3u; }
}
)";
    for (const uint32_t width : {5u, 3u}) {
        auto image = image_of(TexelFormat::standard, width, 2, {});
        image->arrayed = true;
        image->layers = 2;
        image->texels = bytes_of(std::vector<float>(size_t{width} * 2 * 2 * 4, 1.0f));
        ComputeData data;
        data.images = {{"pictures", image, {}}};
        data.buffers = {{"Parts", little<uint32_t>({10})}, {"Parts[1]", little<uint32_t>({20})}};
        data.groups = {width, 2, 2};
        const ComputeResult out = run_clean(text, data);
        const ReadBack* seen = out.image("pictures");
        ASSERT_NE(seen, nullptr);
        EXPECT_EQ(seen->components, 4u);
        const auto values = values_of<float>(bytes_of(seen->words));
        ASSERT_EQ(values.size(), size_t{width} * 2 * 2 * 4);
        const size_t last = values.size() - 4;
        EXPECT_EQ(values[last], static_cast<float>(width));
        EXPECT_EQ(values[last + 1], 2.0f);
        EXPECT_EQ(values[last + 2], 2.0f);
        EXPECT_EQ(values[last + 3], 1.5f);
        EXPECT_EQ(values_of<uint32_t>(out.buffer("Parts[0]")), std::vector<uint32_t>{11});
        EXPECT_EQ(values_of<uint32_t>(out.buffer("Parts[1]")), std::vector<uint32_t>{22});
        EXPECT_EQ(values_of<uint32_t>(out.buffer("Parts[2]")), std::vector<uint32_t>{13});
    }
}

TEST(Compute, MessagesShowTheLine) {
    const Result<StageCode> stage = compute_stage("#version 450\nlayout(local_size_x = 1) in;\nvoid main() { nonsense = 1; }\n");
    ASSERT_FALSE(stage.ok());
    EXPECT_EQ(stage.error().fault, Fault::input);
    EXPECT_NE(stage.error().message.find("3: "), std::string::npos) << stage.error().message;
    EXPECT_NE(stage.error().message.find("    void main() { nonsense = 1; }"), std::string::npos) << stage.error().message;
}

TEST(Compute, SlipsAreNamed) {
    const Result<StageCode> stage = compute_stage(doubler);
    ASSERT_TRUE(stage.ok());
    const struct {
        void (*slip)(ComputeData&);
        const char* problem;
    } cases[] = {
        {[](ComputeData& d) { d.buffers.erase(d.buffers.begin()); }, "buffer 'In' is not given"},
        {[](ComputeData& d) {
             d.buffers.push_back({"Inn", Bytes(4)});
         },
         "no buffer 'Inn'"},
        {[](ComputeData& d) {
             d.buffers.push_back({"Out", Bytes(4)});
         },
         "'Out' is given twice"},
        {[](ComputeData& d) { d.buffers[1].bytes.clear(); }, "buffer 'Out' has 0 bytes"},
        {[](ComputeData& d) { d.buffers[2].bytes.resize(4); }, "needs at least 8"},
        {[](ComputeData& d) { d.push_constants.clear(); }, "push constants"},
        {[](ComputeData& d) {
             d.images.push_back({"picture", nullptr, {}});
         },
         "no image 'picture'"},
        {[](ComputeData& d) {
             d.samplers.push_back({"smooth", {}});
         },
         "no sampler 'smooth'"},
    };
    for (const auto& c : cases) {
        ComputeData data = doubler_data(4);
        c.slip(data);
        const auto request = compute_request(*stage, {data});
        ASSERT_FALSE(request.ok()) << c.problem;
        EXPECT_NE(request.error().message.find(c.problem), std::string::npos) << request.error().message;
    }
    EXPECT_FALSE(compute_request(*stage, {}).ok());
}

TEST(Compute, ImagesMustSuitTheirDeclaration) {
    const Result<StageCode> stage = compute_stage(
        "#version 450\nlayout(binding = 0) uniform sampler2DArray t;\nlayout(binding = 1) buffer Out { vec4 v; };\n"
        "void main() { v = texture(t, vec3(0.5)); }\n");
    ASSERT_TRUE(stage.ok());
    const auto problem = [&](void (*slip)(ImageData&)) {
        auto image = image_of(TexelFormat::rgba8_unorm, 2, 2, Bytes(2 * 2 * 4 * 3));
        image->arrayed = true;
        image->layers = 3;
        slip(*image);
        ComputeData data;
        data.buffers = {{"Out", Bytes(16)}};
        data.images = {{"t", image, {}}};
        const auto request = compute_request(*stage, {data});
        return request.ok() ? std::string() : request.error().message;
    };
    EXPECT_EQ(problem([](ImageData&) {}), "");
    EXPECT_NE(problem([](ImageData& i) { i.arrayed = false; }).find("declared as 2D array and given as 2D"), std::string::npos);
    EXPECT_NE(problem([](ImageData& i) { i.dim = ImageDim::cube; }).find("given as cube array"), std::string::npos);
    EXPECT_NE(problem([](ImageData& i) { i.width = 0; }).find("size of 0"), std::string::npos);
    EXPECT_NE(problem([](ImageData& i) { i.layers = 2; }).find("48 bytes of rgba8_unorm"), std::string::npos);
    EXPECT_NE(problem([](ImageData& i) {
                  i.format = TexelFormat::standard;
                  i.base = BaseType::uint32;
              }).find("another type"),
              std::string::npos);
}

}  // namespace
}  // namespace kiln::test
