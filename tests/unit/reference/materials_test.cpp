// Material parameters at their ends.

#include "uber/reference/materials.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

TEST(Materials, MetalsHaveNoDiffuse) {
    EXPECT_NEAR(metallic_f0(splat3(0.9), 0.0, 0.5).x, 0.04, 1e-15);
    EXPECT_NEAR(metallic_f0(splat3(0.9), 1.0, 0.5).x, 0.9, 1e-15);
    EXPECT_NEAR(metallic_f0(splat3(0.9), 0.5, 1.0).x, 0.49, 1e-15);
    EXPECT_NEAR(metallic_diffuse(splat3(0.9), 0.0).x, 0.9, 1e-15);
    EXPECT_EQ(metallic_diffuse(splat3(0.9), 2.0).x, 0.0);
    EXPECT_EQ(reflectance(splat3(0.5), splat3(4.0)).x, 1.0);
    EXPECT_EQ(reflectance(splat3(0.5), splat3(0.5)).y, 0.25);
}

}  // namespace
}  // namespace kiln::reference
