// Formats of what members read: halves against their definition.
#include "compiler/report/resources.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kiln::report {
namespace {

TEST(Halves, EveryHalfComesBack) {
    for (uint32_t h = 0; h < 0x10000u; ++h) {
        const float value = float_of_half(static_cast<uint16_t>(h));
        if (std::isnan(value))
            EXPECT_TRUE(std::isnan(float_of_half(half_of(value)))) << h;
        else
            EXPECT_EQ(half_of(value), h) << value;
    }
}

// Between two halves the nearer is taken, and in the middle the even one.
TEST(Halves, RoundToNearestEven) {
    for (uint32_t h = 0; h < 0x7bffu; ++h) {
        const float low = float_of_half(static_cast<uint16_t>(h)), high = float_of_half(static_cast<uint16_t>(h + 1));
        const float middle = 0.5f * (low + high);
        EXPECT_EQ(half_of(middle), h % 2 == 0 ? h : h + 1) << middle;
        EXPECT_EQ(half_of(std::nextafter(middle, 0.0f)), h) << middle;
        EXPECT_EQ(half_of(std::nextafter(middle, 1e9f)), h + 1) << middle;
    }
    EXPECT_EQ(half_of(65519.9f), 0x7bffu);
    EXPECT_EQ(half_of(65520.0f), 0x7c00u);
    EXPECT_EQ(half_of(-std::numeric_limits<float>::infinity()), 0xfc00u);
}

TEST(Texels, SrgbEncodesColourAndNotAlpha) {
    const Bytes bytes = encode_texels(TexelFormat::rgba8_srgb, {0.0f, 0.215861f, 1.0f, 0.5f});
    EXPECT_EQ(bytes, (Bytes{0, 128, 255, 128}));
}

}  // namespace
}  // namespace kiln::report
