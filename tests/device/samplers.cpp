// What a sampler's state does, on textures small enough to work out by hand. Filtering in all but eight-bit formats is exact on
// lavapipe, and with GALLIVM_PERF=no_aos_sampling in those as well, so tolerances are the rounding of a few operations.

#include <cmath>

#include "tests/device/fetch.h"

namespace kiln::test {
namespace {

constexpr float rounding = 0x1p-21f;  // of a blend of two or four values of at most 1

std::shared_ptr<const ImageData> row() {
    static const auto image = image_of(TexelFormat::r32_float, 4, 1, little<float>({1, 2, 3, 4}));
    return image;
}

float at(float u, const SamplerState& state) {
    return look("sampler2D", "texture(t, p.xy)", {{u, 0.5f, 0, 0}}, row(), state)[0][0];
}

TEST(Samplers, Wraps) {
    const struct {
        Wrap wrap;
        Filter filter;
        float u, wanted;
    } cases[] = {
        {Wrap::repeat, Filter::nearest, 1.125f, 1},        {Wrap::repeat, Filter::nearest, -0.125f, 4},
        {Wrap::mirror, Filter::nearest, 1.125f, 4},        {Wrap::mirror, Filter::nearest, -0.375f, 2},
        {Wrap::clamp, Filter::nearest, 1.625f, 4},         {Wrap::clamp, Filter::nearest, -3.0f, 1},
        {Wrap::border_black, Filter::nearest, 1.125f, 0},  {Wrap::border_black, Filter::nearest, 0.875f, 4},
        {Wrap::border_white, Filter::nearest, -0.125f, 1}, {Wrap::repeat, Filter::linear, 0.0f, 2.5f},
        {Wrap::mirror, Filter::linear, 0.0f, 1},           {Wrap::clamp, Filter::linear, 1.0f, 4},
        {Wrap::border_black, Filter::linear, 0.0f, 0.5f},  {Wrap::border_white, Filter::linear, 1.0f, 2.5f},
        {Wrap::clamp, Filter::linear, 0.3125f, 1.75f},
    };
    for (const auto& c : cases)
        EXPECT_NEAR(at(c.u, {c.filter, MipFilter::none, c.wrap, Comparison::off}), c.wanted, 4 * rounding)
            << "wrap " << static_cast<int>(c.wrap) << " filter " << static_cast<int>(c.filter) << " at " << c.u;
    const SamplerState black{Filter::nearest, MipFilter::none, Wrap::border_black, Comparison::off};
    EXPECT_EQ(look("sampler2D", "texture(t, p.xy)", {{-1, 0.5f, 0, 0}}, row(), black)[0], (Texel{0, 0, 0, 1}));
}

TEST(Samplers, WithoutAStateTheyAreLinearAndRepeat) {
    EXPECT_EQ(look("sampler2D", "texture(t, p.xy)", {{0.0f, 0.5f, 0, 0}}, row())[0][0], 2.5f);
    EXPECT_EQ(SamplerState(), (SamplerState{Filter::linear, MipFilter::linear, Wrap::repeat, Comparison::off}));
}

TEST(Samplers, Mips) {
    const auto image = image_of(TexelFormat::r32_float, 2, 2, little<float>({1, 1, 1, 1, 5}), 2);
    const std::vector<Texel> levels = {{0.5f, 0.5f, 0.25f, 0}, {0.5f, 0.5f, 0.75f, 0}, {0.5f, 0.5f, 7.0f, 0}};
    const auto seen = [&](MipFilter mips) {
        return look("sampler2D", "textureLod(t, p.xy, p.z)", levels, image,
                    SamplerState{Filter::linear, mips, Wrap::clamp, Comparison::off});
    };
    const auto none = seen(MipFilter::none), nearest = seen(MipFilter::nearest), linear = seen(MipFilter::linear);
    for (const Texel& t : none) EXPECT_EQ(t[0], 1.0f);
    EXPECT_EQ(nearest[0][0], 1.0f);
    EXPECT_EQ(nearest[1][0], 5.0f);
    EXPECT_NEAR(linear[0][0], 2.0f, 8 * rounding);
    EXPECT_NEAR(linear[1][0], 4.0f, 8 * rounding);
    EXPECT_EQ(linear[2][0], 5.0f);
}

// A ramp from 0 to 1 over two texels, looked at in 512 places between their centres.
void expect_exact_ramp(TexelFormat format, Bytes texels) {
    std::vector<Texel> places;
    for (int i = 0; i <= 512; ++i) places.push_back({0.25f + 0.5f * static_cast<float>(i) / 512, 0.5f, 0, 0});
    const auto seen = look("sampler2D", "texture(t, p.xy)", places, image_of(format, 2, 1, std::move(texels)),
                           SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::off});
    for (size_t i = 0; i < seen.size(); ++i) EXPECT_NEAR(seen[i][0], static_cast<float>(i) / 512, rounding) << "place " << i;
}

TEST(Samplers, LinearFilteringIsExact) {
    expect_exact_ramp(TexelFormat::r16_unorm, little<uint16_t>({0, 0xffff}));
    expect_exact_ramp(TexelFormat::r16_float, little<uint16_t>({0, 0x3c00}));
    expect_exact_ramp(TexelFormat::r32_float, little<float>({0, 1}));
    expect_exact_ramp(TexelFormat::rgba8_unorm, {0, 0, 0, 0, 255, 0, 0, 0});
    expect_exact_ramp(TexelFormat::r8_unorm, {0, 255});
    expect_exact_ramp(TexelFormat::rgba8_srgb, {0, 0, 0, 0, 255, 0, 0, 0});
}

TEST(Samplers, Compare) {
    for (const bool wide : {true, false}) {
        const auto image = wide ? image_of(TexelFormat::d32_float, 2, 1, little<float>({0.25f, 0.75f}))
                                : image_of(TexelFormat::d16_unorm, 2, 1, little<uint16_t>({0x4000, 0xc000}));
        const auto seen = [&](Comparison compare, Filter filter) {
            const std::vector<Texel> places = {{0.25f, 0.5f, 0.5f, 0}, {0.75f, 0.5f, 0.5f, 0}, {0.5f, 0.5f, 0.5f, 0}};
            return look("sampler2DShadow", "texture(t, p.xyz)", places, image,
                        SamplerState{filter, MipFilter::none, Wrap::clamp, compare});
        };
        const auto less = seen(Comparison::less_or_equal, Filter::linear);
        EXPECT_EQ(less[0][0], 0.0f) << "0.5 <= 0.25";
        EXPECT_EQ(less[1][0], 1.0f);
        EXPECT_NEAR(less[2][0], 0.5f, rounding) << "comparisons are blended, not depths";
        const auto greater = seen(Comparison::greater, Filter::nearest);
        EXPECT_EQ(greater[0][0], 1.0f);
        EXPECT_EQ(greater[1][0], 0.0f);
    }
    const auto flat = image_of(TexelFormat::d32_float, 1, 1, little<float>({0.5f}));
    const auto equal = [&](Comparison compare) {
        return look("sampler2DShadow", "texture(t, p.xyz)", {{0.5f, 0.5f, 0.5f, 0}}, flat,
                    SamplerState{Filter::nearest, MipFilter::none, Wrap::clamp, compare})[0][0];
    };
    EXPECT_EQ(equal(Comparison::less_or_equal), 1.0f);
    EXPECT_EQ(equal(Comparison::less), 0.0f);
    EXPECT_EQ(equal(Comparison::greater_or_equal), 1.0f);
    EXPECT_EQ(equal(Comparison::greater), 0.0f);
    // A border of 1 lets everything outside a shadow map be lit, one of 0 be dark.
    const auto outside = [&](Wrap wrap) {
        return look("sampler2DShadow", "texture(t, p.xyz)", {{1.5f, 0.5f, 0.5f, 0}}, flat,
                    SamplerState{Filter::nearest, MipFilter::none, wrap, Comparison::less_or_equal})[0][0];
    };
    EXPECT_EQ(outside(Wrap::border_white), 1.0f);
    EXPECT_EQ(outside(Wrap::border_black), 0.0f);
}

TEST(Samplers, SeparateOnesAndSeveralOverOneImage) {
    const std::string text = R"(
layout(local_size_x = 1) in;
layout(set = 0, binding = 0) uniform texture2D image;
layout(set = 0, binding = 1) uniform sampler near_one;
layout(set = 0, binding = 2) uniform sampler dark_one;
layout(set = 0, binding = 7) uniform sampler smooth_one;
layout(set = 0, binding = 3) uniform texture2D depth_image;
layout(set = 0, binding = 4) uniform samplerShadow compared;
layout(set = 0, binding = 5) uniform sampler2D combined;
layout(set = 0, binding = 6) buffer Out { float v[5]; };
void main() {
    v[0] = texture(sampler2D(image, near_one), vec2(0.0, 0.5)).r;
    v[1] = texture(sampler2D(image, smooth_one), vec2(0.0, 0.5)).r;
    v[2] = texture(sampler2D(image, dark_one), vec2(0.0, 0.5)).r;
    v[3] = texture(sampler2DShadow(depth_image, compared), vec3(0.5, 0.5, 0.5));
    v[4] = texture(combined, vec2(1.0, 0.5)).r;
}
)";
    ComputeData data;
    data.buffers = {{"Out", Bytes(20)}};
    const SamplerState black{Filter::linear, MipFilter::none, Wrap::border_black, Comparison::off};
    data.images = {{"image", row(), {}},
                   {"depth_image", image_of(TexelFormat::d32_float, 1, 1, little<float>({0.25f})), {}},
                   {"combined", row(), black}};
    data.samplers = {{"near_one", {Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::off}},
                     {"dark_one", black},
                     {"compared", {Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::greater}}};
    const auto v = values_of<float>(run_clean(text, data).buffer("Out"));
    EXPECT_EQ(v, (std::vector<float>{1.0f, 2.5f, 0.5f, 1.0f, 2.0f}));
}

TEST(Samplers, IntegersTakeBordersOfTheirOwn) {
    auto image = image_of(TexelFormat::standard, 1, 1, little<uint32_t>({7, 8, 9, 10}));
    image->base = BaseType::uint32;
    const SamplerState white{Filter::nearest, MipFilter::none, Wrap::border_white, Comparison::off};
    const auto seen = look("usampler2D", "texture(t, p.xy)", {{0.5f, 0.5f, 0, 0}, {2, 2, 0, 0}}, image, white);
    EXPECT_EQ(seen[0], (Texel{7, 8, 9, 10}));
    EXPECT_EQ(seen[1], (Texel{1, 1, 1, 1}));
}

TEST(Samplers, ComparingMustSuitTheShader) {
    const Result<StageCode> stage = compute_stage(
        "#version 450\nlayout(binding = 0) uniform sampler2DShadow t;\nlayout(binding = 1) buffer Out { float v; };\n"
        "void main() { v = texture(t, vec3(0.5)); }\n");
    ASSERT_TRUE(stage.ok());
    ComputeData data;
    data.buffers = {{"Out", Bytes(4)}};
    data.images = {{"t", image_of(TexelFormat::d32_float, 1, 1, little<float>({0.5f})), SamplerState()}};
    const Result<ComputeResult> out = run_compute(device(), *stage, data);
    ASSERT_FALSE(out.ok());
    EXPECT_NE(out.error().message.find("'t'"), std::string::npos) << out.error().message;
}

// Faces hold 1 to 6. In the middle of an edge of a cube two faces meet and count one half each.
TEST(Samplers, CubesJoinAtTheirEdges) {
    auto cube = image_of(TexelFormat::r32_float, 2, 2, {});
    cube->dim = ImageDim::cube;
    cube->layers = 6;
    for (float face = 1; face <= 6; ++face) {
        const Bytes texels = little<float>({face, face, face, face});
        cube->texels.insert(cube->texels.end(), texels.begin(), texels.end());
    }
    const std::vector<Texel> faces = {{1, 0, 0, 0}, {-1, 0, 0, 0}, {0, 1, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}, {0, 0, -1, 0}};
    const auto middle = look("samplerCube", "texture(t, p.xyz)", faces, cube);
    for (size_t i = 0; i < 6; ++i) EXPECT_EQ(middle[i][0], static_cast<float>(i + 1));
    const std::vector<Texel> edges = {{1, 0, 1, 0}, {1, 0, -1, 0}, {-1, 0, 1, 0}, {1, 1, 0, 0}, {0, -1, 1, 0}, {0, 1, -1, 0}};
    const float wanted[] = {3, 3.5f, 3.5f, 2, 4.5f, 4.5f};
    const auto joined = look("samplerCube", "texture(t, p.xyz)", edges, cube);
    const auto apart = look("samplerCube", "texture(t, p.xyz)", edges, cube,
                            SamplerState{Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::off});
    for (size_t i = 0; i < edges.size(); ++i) {
        EXPECT_NEAR(joined[i][0], wanted[i], 8 * rounding) << "edge " << i;
        EXPECT_EQ(apart[i][0], std::floor(apart[i][0])) << "nearest takes one face";
    }
}

TEST(Samplers, CubeArraysOfBlocksAndMips) {
    auto cubes = image_of(TexelFormat::bc4_unorm, 4, 4, {}, 3);
    cubes->dim = ImageDim::cube;
    cubes->arrayed = true;
    cubes->layers = 12;
    for (uint8_t i = 0; i < 36; ++i) {  // one block a layer and mip
        const Bytes block = {static_cast<uint8_t>(5 * i), 0, 0, 0, 0, 0, 0, 0};
        cubes->texels.insert(cubes->texels.end(), block.begin(), block.end());
    }
    const auto seen = look("samplerCubeArray", "vec4(textureLod(t, vec4(-1.0, 0.0, 0.0, p.x), p.y).r)",
                           {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {0, 2, 0, 0}}, cubes);
    const float wanted[] = {1, 7, 19, 25};
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(seen[i][0], 5 * wanted[i] / 255, rounding) << i;
}

}  // namespace
}  // namespace kiln::test
