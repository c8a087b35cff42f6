// Irradiance from raw moments, for skies whose irradiance is known.

#include "uber/reference/sh_lightmap.h"

#include <gtest/gtest.h>

#include "uber/reference/furnace.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(ShLightmap, GivesIrradianceFromRawMoments) {
    const V3 none{0, 0, 0}, one{1, 1, 1};
    EXPECT_NEAR(sh_l1_irradiance(splat3(4 * pi), none, none, none, from_polar(0.3, 1)).x, pi, 1e-14);  // L = 1
    for (const double c : {1.0, 0.5, 0.0, -0.4, -1.0})  // unit irradiance from (0, 0, 1): 0.25 + 0.5 c, not below 0
        EXPECT_NEAR(sh_l1_irradiance(one, none, one, none, from_polar(c, 2)).x, std::max(0.0, 0.25 + 0.5 * c), 1e-15);
    // Light from above with radiance 1: m0 = 2 pi, m1 = pi; E = pi (1 + c) / 2.
    EXPECT_NEAR(sh_l1_irradiance(splat3(2 * pi), none, splat3(0.5), none, from_polar(0.6, 0)).x, pi * 0.8, 1e-14);
    // Each coefficient goes with its own axis, y z x.
    EXPECT_EQ(sh_l1_irradiance(one, one, none, none, V3{0, 1, 0}).x, 0.75);
    EXPECT_EQ(sh_l1_irradiance(one, none, none, one, V3{1, 0, 0}).x, 0.75);
}

TEST(ShLightmap, RatiosAreStoredHalved) {
    EXPECT_EQ(decode_sh_ratio(splat3(0.5)).x, 0.0);
    EXPECT_EQ(decode_sh_ratio(splat3(1.0)).y, 1.0);
    EXPECT_EQ(decode_sh_ratio(splat3(0.0)).z, -1.0);
}

}  // namespace
}  // namespace kiln::reference
