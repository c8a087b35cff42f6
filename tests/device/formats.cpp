// Known texels through every format. Formats that only reinterpret bits must give them exactly; normalised ones divide, which
// may cost an ulp or two. Blocks are put together by hand: BC6H and BC7 decode bit by bit as their specification says, the
// older ones may round an interpolated colour by one step of 255.

#include <cmath>

#include "compiler/validate/texels.h"
#include "tests/device/fetch.h"

namespace kiln::test {
namespace {

constexpr float ulps = 0x1p-22f;           // of values up to 1: two units in the last place of a division
constexpr float step = 1.0f / 255 + ulps;  // one code of eight bits

void expect_texel(const Texel& seen, const Texel& wanted, float tolerance) {
    for (size_t c = 0; c < 4; ++c) EXPECT_NEAR(seen[c], wanted[c], tolerance) << "component " << c;
}

class Bits {
public:
    Bits& put(uint32_t value, uint32_t count) {
        for (uint32_t i = 0; i < count; ++i, ++at_)
            if ((value >> i & 1) != 0) block_[at_ / 8] = static_cast<uint8_t>(block_[at_ / 8] | 1u << (at_ % 8));
        return *this;
    }
    Bytes block() const {
        EXPECT_EQ(at_, 128u);
        return block_;
    }

private:
    Bytes block_ = Bytes(16);
    uint32_t at_ = 0;
};

struct Case {
    const char* name;
    TexelFormat format;
    Bytes texel;
    Texel wanted;
    float tolerance;
};

TEST(Formats, OneTexelOfEach) {
    const Case cases[] = {
        {"rgba8", TexelFormat::rgba8_unorm, {0, 51, 102, 255}, {0.0f, 0.2f, 0.4f, 1.0f}, ulps},
        {"r8", TexelFormat::r8_unorm, {51}, {0.2f, 0.0f, 0.0f, 1.0f}, ulps},
        {"rg8", TexelFormat::rg8_unorm, {51, 204}, {0.2f, 0.8f, 0.0f, 1.0f}, ulps},
        {"r16", TexelFormat::r16_unorm, little<uint16_t>({0x3333}), {0.2f, 0.0f, 0.0f, 1.0f}, ulps},
        {"rg16", TexelFormat::rg16_unorm, little<uint16_t>({0x3333, 0xffff}), {0.2f, 1.0f, 0.0f, 1.0f}, ulps},
        {"rgba16", TexelFormat::rgba16_unorm, little<uint16_t>({0, 0x3333, 0x6666, 0xffff}), {0.0f, 0.2f, 0.4f, 1.0f}, ulps},
        {"r16f", TexelFormat::r16_float, little<uint16_t>({0x3555}), {0.333251953125f, 0, 0, 1}, 0},
        {"rg16f", TexelFormat::rg16_float, little<uint16_t>({0xc000, 0x7bff}), {-2, 65504, 0, 1}, 0},
        {"rgba16f", TexelFormat::rgba16_float, little<uint16_t>({0x3c00, 0xc000, 0x0400, 0x7bff}), {1, -2, 0x1p-14f, 65504}, 0},
        {"r32f", TexelFormat::r32_float, little<float>({0.1f}), {0.1f, 0, 0, 1}, 0},
        {"rg32f", TexelFormat::rg32_float, little<float>({0.1f, -3e38f}), {0.1f, -3e38f, 0, 1}, 0},
        {"rgba32f", TexelFormat::rgba32_float, little<float>({0.1f, -1, 1e-30f, 7}), {0.1f, -1, 1e-30f, 7}, 0},
        {"standard", TexelFormat::standard, little<float>({0.1f, -1, 1e-30f, 7}), {0.1f, -1, 1e-30f, 7}, 0},
        {"rgb10a2",
         TexelFormat::rgb10a2_unorm,
         little<uint32_t>({1023u | 0u << 10 | 341u << 20 | 2u << 30}),
         {1.0f, 0.0f, 1.0f / 3, 2.0f / 3},
         ulps},
        // Exponent 15 is 1; six bits of fraction for red and green, five for blue.
        {"rg11b10",
         TexelFormat::rg11b10_float,
         little<uint32_t>({15u << 6 | (13u << 6 | 32u) << 11 | (30u << 5 | 31u) << 22}),
         {1.0f, 0.375f, 64512.0f, 1.0f},
         0},
        // Mantissa / 512 * 2^(exponent - 15), without an implied one.
        {"rgb9e5",
         TexelFormat::rgb9e5_float,
         little<uint32_t>({256u | 511u << 9 | 1u << 18 | 15u << 27}),
         {0.5f, 511.0f / 512, 1.0f / 512, 1.0f},
         0},
        {"rgb9e5 at its end",
         TexelFormat::rgb9e5_float,
         little<uint32_t>({511u | 0u << 9 | 2u << 18 | 31u << 27}),
         {65408.0f, 0.0f, 256.0f, 1.0f},
         0},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        ASSERT_EQ(c.texel.size(), block_of(c.format).bytes);
        expect_texel(fetch_all(image_of(c.format, 1, 1, c.texel)).at(0), c.wanted, c.tolerance);
    }
}

TEST(Formats, DepthIsReadAsIs) {
    const auto deep = fetch_all(image_of(TexelFormat::d16_unorm, 3, 1, little<uint16_t>({0, 0x3333, 0xffff})));
    EXPECT_EQ(deep[0][0], 0.0f);
    EXPECT_NEAR(deep[1][0], 0.2f, ulps);
    EXPECT_EQ(deep[2][0], 1.0f);
    EXPECT_EQ(fetch_all(image_of(TexelFormat::d32_float, 1, 1, little<float>({0.1f}))).at(0)[0], 0.1f);
}

// A decoder of sRGB may be off by half a code and no more: encoding what it gave must round to the code again.
void expect_srgb_code(float linear, uint8_t code) {
    const double l = static_cast<double>(linear);
    const double encoded = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
    EXPECT_NEAR(encoded * 255, code, 0.5);
}

TEST(Formats, SrgbIsLinearisedButForAlpha) {
    const auto seen = fetch_all(image_of(TexelFormat::rgba8_srgb, 2, 1, {0, 5, 128, 128, 188, 254, 255, 255}));
    expect_srgb_code(seen[0][0], 0);
    expect_srgb_code(seen[0][1], 5);
    expect_srgb_code(seen[0][2], 128);
    EXPECT_NEAR(seen[0][3], 128.0f / 255, ulps);
    expect_srgb_code(seen[1][0], 188);
    expect_srgb_code(seen[1][1], 254);
    expect_srgb_code(seen[1][2], 255);
}

// Red, blue and what lies between; row 1 is the same backwards.
const Bytes bc1_block = {0x00, 0xf8, 0x1f, 0x00, 0xe4, 0x1b, 0x00, 0x55};

TEST(Formats, Bc1) {
    const auto seen = fetch_all(image_of(TexelFormat::bc1_rgb_unorm, 4, 4, bc1_block));
    expect_texel(seen[0], {1, 0, 0, 1}, ulps);
    expect_texel(seen[1], {0, 0, 1, 1}, ulps);
    expect_texel(seen[2], {2.0f / 3, 0, 1.0f / 3, 1}, step);
    expect_texel(seen[3], {1.0f / 3, 0, 2.0f / 3, 1}, step);
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(seen[4 + i], seen[3 - i]);
    expect_texel(seen[8], {1, 0, 0, 1}, ulps);
    expect_texel(seen[15], {0, 0, 1, 1}, ulps);
    // The smaller colour first: three colours and black, which is opaque in the RGB format.
    const auto three = fetch_all(image_of(TexelFormat::bc1_rgb_unorm, 4, 4, {0x1f, 0x00, 0x00, 0xf8, 0xe4, 0, 0, 0}));
    expect_texel(three[0], {0, 0, 1, 1}, ulps);
    expect_texel(three[2], {0.5f, 0, 0.5f, 1}, step);
    expect_texel(three[3], {0, 0, 0, 1}, ulps);
    // Green 31 of 63 expands to 125.
    const auto grey = fetch_all(image_of(TexelFormat::bc1_rgb_srgb, 4, 4, {0xe0, 0x03, 0, 0, 0, 0, 0, 0}));
    expect_srgb_code(grey[0][1], 125);
}

TEST(Formats, Bc3Bc4Bc5) {
    // From 255 to 0 in eight steps; texels 0, 1, 2, 3 take indices 0, 1, 2, 7.
    const Bytes ramp = {255, 0, 0x88, 0x0e, 0, 0, 0, 0};
    const float wanted[] = {1.0f, 0.0f, 6.0f / 7, 1.0f / 7};
    // From 0 to 255: six steps, then 0 and 1. Texels 0, 1, 2, 3 take indices 1, 2, 6, 7.
    const Bytes ends = {0, 255, 0x91, 0x0f, 0, 0, 0, 0};
    const float wanted_ends[] = {1.0f, 0.2f, 0.0f, 1.0f};
    Bytes both = ramp;
    both.insert(both.end(), bc1_block.begin(), bc1_block.end());
    const auto bc3 = fetch_all(image_of(TexelFormat::bc3_unorm, 4, 4, both));
    const auto bc4 = fetch_all(image_of(TexelFormat::bc4_unorm, 4, 4, ramp));
    Bytes two = ramp;
    two.insert(two.end(), ends.begin(), ends.end());
    const auto bc5 = fetch_all(image_of(TexelFormat::bc5_unorm, 4, 4, two));
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(bc3[i][3], wanted[i], step);
        EXPECT_EQ(bc4[i][0], bc3[i][3]);
        EXPECT_EQ(bc5[i][0], bc4[i][0]);
        EXPECT_NEAR(bc5[i][1], wanted_ends[i], step);
        EXPECT_EQ(bc5[i][2], 0.0f);
    }
    expect_texel(bc4[0], {1, 0, 0, 1}, ulps);
    EXPECT_NEAR(bc3[1][2], 1.0f, ulps);
    Bytes green = ramp;
    green.insert(green.end(), {0xe0, 0x03, 0, 0, 0, 0, 0, 0});
    const auto srgb = fetch_all(image_of(TexelFormat::bc3_srgb, 4, 4, green));
    expect_srgb_code(srgb[2][1], 125);
    EXPECT_NEAR(srgb[2][3], 6.0f / 7, step) << "alpha stays linear";
}

// Mode 11 of BC6H: one region, end points of ten bits each. An end point x of ten bits stands for the half-float with the bits
// 31 x + 15, so 495 is 1.0; 1023 is the largest half-float and 0 is 0.
TEST(Formats, Bc6h) {
    Bits b;
    b.put(3, 5);
    b.put(495, 10).put(0, 10).put(0, 10);
    b.put(1023, 10).put(495, 10).put(0, 10);
    b.put(0, 3).put(15, 4).put(8, 4);
    for (uint32_t i = 3; i < 16; ++i) b.put(0, 4);
    const auto seen = fetch_all(image_of(TexelFormat::bc6h_ufloat, 4, 4, b.block()));
    expect_texel(seen[0], {1, 0, 0, 1}, 0);
    expect_texel(seen[1], {65504, 1, 0, 1}, 0);
    // Index 8 weighs 34 of 64: (31712 * 34 + 32) / 64 = 16847, times 31 / 64 = 8160 = 0x1fe0.
    EXPECT_EQ(seen[2][1], 0x1p-8f * (1.0f + 992.0f / 1024));
    // Red: (31712 * 30 + 65535 * 34 + 32) / 64 = 49680, times 31 / 64 = 24063 = 0x5dff.
    EXPECT_EQ(seen[2][0], 0x1p8f * (1.0f + 511.0f / 1024));
    expect_texel(seen[15], {1, 0, 0, 1}, 0);
}

// Mode 6 of BC7: one region, seven bits and a shared low bit an end point, four bits an index.
Bytes bc7_block() {
    Bits b;
    b.put(0x40, 7);
    b.put(0, 7).put(127, 7);    // red 0 to 255
    b.put(127, 7).put(0, 7);    // green 254 to 1
    b.put(50, 7).put(50, 7);    // blue 100 to 101
    b.put(127, 7).put(127, 7);  // alpha 254 to 255
    b.put(0, 1).put(1, 1);
    b.put(0, 3).put(15, 4).put(8, 4);
    for (uint32_t i = 3; i < 16; ++i) b.put(0, 4);
    return b.block();
}

TEST(Formats, Bc7) {
    const auto seen = fetch_all(image_of(TexelFormat::bc7_unorm, 4, 4, bc7_block()));
    const auto codes = [](float r, float g, float b, float a) { return Texel{r / 255, g / 255, b / 255, a / 255}; };
    expect_texel(seen[0], codes(0, 254, 100, 254), ulps);
    expect_texel(seen[1], codes(255, 1, 101, 255), ulps);
    expect_texel(seen[2], codes(135, 120, 101, 255), ulps);  // weight 34 of 64, rounded
    const auto srgb = fetch_all(image_of(TexelFormat::bc7_srgb, 4, 4, bc7_block()));
    expect_srgb_code(srgb[2][0], 135);
    expect_srgb_code(srgb[2][1], 120);
    EXPECT_NEAR(srgb[0][3], 254.0f / 255, ulps);
}

Bytes solid_bc1(uint32_t red) { return {0, static_cast<uint8_t>(red << 3), 0, 0, 0, 0, 0, 0}; }

TEST(Formats, MipsOfBlocksAndOfOddSizes) {
    ImageData size;
    size.format = TexelFormat::bc1_rgb_unorm;
    size.width = 6;
    size.height = 10;
    size.mips = 4;
    EXPECT_EQ(mip_bytes(size, 0), 2u * 3 * 8);
    EXPECT_EQ(mip_bytes(size, 1), 1u * 2 * 8);
    EXPECT_EQ(mip_bytes(size, 3), 8u);
    EXPECT_EQ(image_bytes(size), 10u * 8);
    Bytes blocks;
    for (uint32_t i = 0; i < 10; ++i) {
        const Bytes b = solid_bc1(3 * i);
        blocks.insert(blocks.end(), b.begin(), b.end());
    }
    const auto red = [](uint32_t i) { return static_cast<float>((3 * i) << 3 | (3 * i) >> 2) / 255; };
    const auto image = image_of(TexelFormat::bc1_rgb_unorm, 6, 10, blocks, 4);
    const auto top = fetch_all(image);
    EXPECT_NEAR(top[0][0], red(0), ulps);
    EXPECT_NEAR(top[5][0], red(1), ulps);
    EXPECT_NEAR(top[9 * 6 + 5][0], red(5), ulps);
    const auto second = fetch_all(image, 1);
    EXPECT_NEAR(second[0][0], red(6), ulps);
    EXPECT_NEAR(second[4 * 3 + 2][0], red(7), ulps);
    EXPECT_NEAR(fetch_all(image, 2)[0][0], red(8), ulps);
    EXPECT_NEAR(fetch_all(image, 3)[0][0], red(9), ulps);

    // Mips of one byte or two a texel lie at odd places of the upload.
    const auto odd = image_of(TexelFormat::r8_unorm, 3, 3, {0, 0, 0, 0, 0, 0, 0, 0, 51, 102}, 2);
    EXPECT_NEAR(fetch_all(odd)[8][0], 0.2f, ulps);
    EXPECT_NEAR(fetch_all(odd, 1)[0][0], 0.4f, ulps);
    const auto depth = image_of(TexelFormat::d16_unorm, 3, 1, little<uint16_t>({0, 0, 0, 0x3333}), 2);
    EXPECT_NEAR(fetch_all(depth, 1)[0][0], 0.2f, ulps);
}

TEST(Formats, LayersAndSlices) {
    auto layers = image_of(TexelFormat::bc1_rgb_unorm, 8, 4, {}, 2);
    layers->arrayed = true;
    layers->layers = 3;
    for (const uint32_t red : {0u, 1u, 2u, 3u, 4u, 5u, 16u, 17u, 18u}) {  // mip 0: two blocks a layer; mip 1: one
        const Bytes b = solid_bc1(red);
        layers->texels.insert(layers->texels.end(), b.begin(), b.end());
    }
    const auto red = [](uint32_t i) { return static_cast<float>(i << 3 | i >> 2) / 255; };
    const auto seen =
        look("sampler2DArray", "texelFetch(t, ivec3(p.xyz), int(p.w))", {{5, 0, 2, 0}, {0, 3, 1, 0}, {3, 1, 2, 1}}, layers);
    EXPECT_NEAR(seen[0][0], red(5), ulps);
    EXPECT_NEAR(seen[1][0], red(2), ulps);
    EXPECT_NEAR(seen[2][0], red(18), ulps);

    auto volume = image_of(TexelFormat::r32_float, 2, 1, little<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}), 2);
    volume->dim = ImageDim::d3;
    volume->slices = 4;
    const auto deep = look("sampler3D", "texelFetch(t, ivec3(p.xyz), int(p.w))", {{1, 0, 3, 0}, {0, 0, 1, 1}}, volume);
    EXPECT_EQ(deep[0][0], 8.0f);
    EXPECT_EQ(deep[1][0], 10.0f);
}

TEST(Formats, WrongSizesAreRefused) {
    const PipelineRequest good = [] {
        const StageCode stage = compute(
            "layout(binding = 0) uniform sampler2D t;\nlayout(binding = 1) buffer Out { vec4 v; };\n"
            "void main() { v = textureLod(t, vec2(0.5), 0.0); }\n");
        return *compute_request(
            stage,
            {ComputeData{{{"Out", Bytes(16)}}, {{"t", image_of(TexelFormat::r8_unorm, 2, 2, Bytes(4)), {}}}, {}, {}, {1, 1, 1}}});
    }();
    PipelineRequest bad = good;
    bad.inputs[0].bindings[0].images[0] = image_of(TexelFormat::r8_unorm, 2, 2, Bytes(5));
    const Result<PipelineOutput> out = device().run(bad);
    ASSERT_TRUE(out.ok());
    ASSERT_EQ(out->errors.size(), 1u);
    EXPECT_NE(out->errors[0].find("r8_unorm"), std::string::npos) << out->errors[0];
    const Result<PipelineOutput> again = device().run(good);
    ASSERT_TRUE(again.ok());
    EXPECT_TRUE(again->errors.empty()) << again->errors.front();
}

}  // namespace
}  // namespace kiln::test
