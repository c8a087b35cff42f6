// sRGB transfer functions: inverse of one another, and the lecture's table of reflectances.

#include "uber/reference/color.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

TEST(Color, EncodeAndDecodeAreInverse) {
    for (int i = 0; i <= 1000; ++i) {
        const double x = i / 1000.0;
        // The two constants of the standard meet only to 4 digits, so between them the pieces differ.
        EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 1e-7) << x;
    }
    for (int i = 0; i < 256; ++i) EXPECT_NEAR(255 * srgb_encode(srgb_decode(i / 255.0)), i, 1e-4) << i;
    EXPECT_NEAR(srgb_encode(1.0), 1.0, 1e-15);
    EXPECT_NEAR(srgb_decode(1.0), 1.0, 1e-15);
    EXPECT_EQ(srgb_encode(-0.5), 0.0);
    EXPECT_EQ(srgb_decode(-0.5), 0.0);
}

TEST(Color, TableOfReflectances) {
    const struct {
        double f0, code;
    } known[] = {{0.02, 38.684},  {0.04, 56.334},  {0.028, 46.617}, {0.025, 43.820}, {0.046, 60.553},
                 {0.058, 68.115}, {0.056, 66.923}, {0.035, 52.526}, {0.05, 63.189},  {0.07, 74.810},
                 {0.08, 79.893},  {0.13, 100.950}, {0.2, 123.555}};
    for (const auto& k : known) EXPECT_NEAR(255 * srgb_encode(k.f0), k.code, 5.1e-4) << k.f0;
}

}  // namespace
}  // namespace kiln::reference
