// Fresnel references against values worked out by hand.

#include "uber/reference/fresnel.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

TEST(Fresnel, SchlickHasTheKnownValues) {
    const Vec3<double> glass = splat3(0.04);
    EXPECT_NEAR(fresnel_schlick(1.0, glass).x, 0.04, 1e-15);
    EXPECT_NEAR(fresnel_schlick(0.5, glass).x, 0.07, 1e-15);  // 0.04 + 0.96 / 32
    EXPECT_NEAR(fresnel_schlick(0.0, glass).x, 1.0, 1e-15);
    EXPECT_NEAR(fresnel_average(glass).x, 0.0857142857142857, 1e-15);
    EXPECT_NEAR(fresnel_schlick(0.0, splat3(0.01)).x, 0.495, 1e-15);  // f90 fades below 2 %
    EXPECT_EQ(fresnel_schlick(1.0000001f, splat3(0.04f)).x, 0.04f);
    EXPECT_EQ(fresnel_schlick(0.3, splat3(0.0)).x, 0.0);
}

}  // namespace
}  // namespace kiln::reference
