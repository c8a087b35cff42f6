// Falloffs against values worked out by hand.

#include "uber/reference/lights.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

TEST(Lights, FallOffAndEnd) {
    EXPECT_NEAR(distance_attenuation(1.0, 10.0), 0.99980001, 1e-12);
    EXPECT_NEAR(distance_attenuation(81.0, 10.0), 0.001460089, 5e-10);
    EXPECT_EQ(distance_attenuation(100.0, 10.0), 0.0);
    EXPECT_NEAR(distance_attenuation(0.0f, 10.0f), 1e4, 1.0);
    EXPECT_EQ(distance_attenuation(1e38f, 10.0f), 0.0f);
}

TEST(Lights, ConesHaveAnInsideAndAnOutside) {
    EXPECT_EQ(cone_attenuation(0.9, 0.8, 0.6), 1.0);
    EXPECT_NEAR(cone_attenuation(0.7, 0.8, 0.6), 0.25, 1e-12);
    EXPECT_EQ(cone_attenuation(0.5, 0.8, 0.6), 0.0);
    EXPECT_EQ(cone_attenuation(0.8, 0.8, 0.8), 0.0);  // a hard edge, not 0/0
    EXPECT_EQ(cone_attenuation(0.9, 0.8, 0.8), 1.0);
}

TEST(Lights, CandelaFromLumen) {
    EXPECT_NEAR(point_light_intensity(800.0), 63.66197723675814, 1e-12);
    EXPECT_NEAR(spot_light_intensity(800.0), 254.64790894703253, 1e-12);
    EXPECT_EQ(spot_light_intensity(0.0), 0.0);
}

}  // namespace
}  // namespace kiln::reference
