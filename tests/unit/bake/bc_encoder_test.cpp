// The BC encoder's wrapper: sizes, hostile texels, and BC1 read back by a decoder of the specification.

#include "compiler/bake/bc_encoder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace kiln {
namespace {

const std::string scripts = std::string(KILN_SOURCE_DIR) + "/compiler/bake";

FloatImage ramp(uint32_t width, uint32_t height) {
    FloatImage image{width, height, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const float t = (static_cast<float>(x + y) + 0.5f) / static_cast<float>(width + height);
            image.rgba.insert(image.rgba.end(), {t, 0.5f * t + 0.25f, 1.0f - t, 1.0f});
        }
    }
    return image;
}

// One BC1 block (Khronos Data Format 1.3, section 18.1), four-colour mode or three colours and black.
std::array<std::array<float, 3>, 16> decode_bc1(const uint8_t* block) {
    float palette[4][3];
    uint32_t ends[2];
    for (int e = 0; e < 2; ++e) {
        ends[e] = block[2 * e] | static_cast<uint32_t>(block[2 * e + 1]) << 8;
        palette[e][0] = static_cast<float>(ends[e] >> 11) / 31.0f;
        palette[e][1] = static_cast<float>(ends[e] >> 5 & 63) / 63.0f;
        palette[e][2] = static_cast<float>(ends[e] & 31) / 31.0f;
    }
    for (int c = 0; c < 3; ++c) {
        const float a = palette[0][c], b = palette[1][c];
        palette[2][c] = ends[0] > ends[1] ? (2 * a + b) / 3 : (a + b) / 2;
        palette[3][c] = ends[0] > ends[1] ? (a + 2 * b) / 3 : 0.0f;
    }
    std::array<std::array<float, 3>, 16> texels;
    for (int i = 0; i < 16; ++i) {
        const int index = block[4 + i / 4] >> 2 * (i % 4) & 3;
        texels[static_cast<size_t>(i)] = {palette[index][0], palette[index][1], palette[index][2]};
    }
    return texels;
}

TEST(BcEncoder, Bc1KeepsARamp) {
    const FloatImage image = ramp(16, 8);
    const Result<BcImage> out = encode_bc(BcFormat::bc1, image, "ramp", scripts);
    ASSERT_TRUE(out.ok()) << out.error().message;
    EXPECT_TRUE(out->warnings.empty());
    ASSERT_EQ(out->blocks.size(), 4u * 2 * 8);
    for (uint32_t y = 0; y < 8; ++y) {
        for (uint32_t x = 0; x < 16; ++x) {
            const auto texels = decode_bc1(&out->blocks[(y / 4 * 4 + x / 4) * 8]);
            for (size_t c = 0; c < 3; ++c) {
                // A block spans 6/24 of the ramp in four steps: half a step, and half a step of 5 bits.
                const float tolerance = 6.0f / 24.0f / 3.0f / 2.0f + 0.5f / 31.0f + 0.01f;
                EXPECT_NEAR(texels[y % 4 * 4 + x % 4][c], image.rgba[4 * (y * 16 + x) + c], tolerance) << x << " " << y;
            }
        }
    }
}

TEST(BcEncoder, SizesThatAreNoMultipleOfFour) {
    for (const BcFormat format : {BcFormat::bc1, BcFormat::bc7, BcFormat::bc6h}) {
        const Result<BcImage> out = encode_bc(format, ramp(5, 1), "odd", scripts);
        ASSERT_TRUE(out.ok()) << out.error().message;
        EXPECT_EQ(out->width, 5u);
        EXPECT_EQ(out->blocks.size(), 2u * bc_block_bytes(format));
    }
}

TEST(BcEncoder, RefusesWhatIsNoImage) {
    const struct {
        FloatImage image;
        const char* message;
    } bad[] = {
        {{0, 4, {}}, "l0: a size of 0 x 4 holds no texel"},
        {{4, 0, {}}, "l0: a size of 4 x 0 holds no texel"},
        {{20000, 1, {}}, "l0: 20000 x 1 is above 16384 a side"},
        {{2, 1, {0, 0, 0, 0}}, "l0: 4 values do not make 2 x 1 texels of four"},
    };
    for (const auto& row : bad) {
        const Result<BcImage> out = encode_bc(BcFormat::bc7, row.image, "l0", scripts);
        ASSERT_FALSE(out.ok());
        EXPECT_EQ(out.error().fault, Fault::input);
        EXPECT_EQ(out.error().message, row.message);
    }
}

TEST(BcEncoder, MissingEncoderIsTheEnvironmentsFault) {
    const Result<BcImage> out = encode_bc(BcFormat::bc7, ramp(4, 4), "l0", "/nonexistent");
    ASSERT_FALSE(out.ok());
    EXPECT_EQ(out.error().fault, Fault::environment);
}

TEST(BcEncoder, HostileTexelsAreNamedAndPutRight) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    FloatImage image = ramp(8, 4);
    image.rgba[4 * (8 * 2 + 3) + 1] = nan;
    image.rgba[4 * (8 * 1 + 5) + 2] = inf;
    image.rgba[4 * (8 * 3 + 5) + 0] = 1e30f;
    image.rgba[4 * 7 + 3] = -inf;
    FloatImage hdr = image;
    EXPECT_EQ(sanitise(hdr, BcFormat::bc6h, "sky"),
              (std::vector<std::string>{"sky: green of texel (3, 2) is not a number: stored as 0",
                                        "sky: alpha of texel (7, 0) is negative: stored as 0",
                                        "sky: blue of texel (5, 1) is above 65504: stored as 65504; so are 1 more values"}));
    for (const float x : hdr.rgba) EXPECT_TRUE(x >= 0.0f && x <= 65504.0f);
    EXPECT_EQ(hdr.rgba[4 * (8 * 1 + 5) + 2], 65504.0f);
    EXPECT_EQ(sanitise(image, BcFormat::bc7, "sky").back(),
              "sky: blue of texel (5, 1) is above 1: stored as 1; so are 1 more values");
    const Result<BcImage> out = encode_bc(BcFormat::bc6h, hdr, "sky", scripts);
    ASSERT_TRUE(out.ok()) << out.error().message;
    EXPECT_TRUE(out->warnings.empty()) << "already put right";
}

}  // namespace
}  // namespace kiln
