// Hard shadows over maps that are known everywhere.

#include "uber/reference/shadow_map.h"

#include <gtest/gtest.h>

#include "uber/reference/depth_map.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(ShadowMap, KeepsVulkansDepthAndAsksOnlyInsideTheMap) {
    // The left half of the map is blocked at depth 0.5, the right is empty.
    const auto map = [](const Vec2<double>& uv, double depth) { return depth <= (uv.x < 0.5 ? 0.5 : 1.0) ? 1.0 : 0.0; };
    const auto lit = [&](double x, double y, double z, double w) {
        return shadow_factor_2d(map, Vec4<double>{x * w, y * w, z * w, w}, 0.001);
    };
    EXPECT_EQ(lit(-0.5, 0.0, 0.4, 2.0), 1.0);
    EXPECT_EQ(lit(-0.5, 0.0, 0.6, 2.0), 0.0);
    EXPECT_EQ(lit(0.5, 0.0, 0.6, 2.0), 1.0);
    EXPECT_EQ(lit(-0.5, 0.0, 0.5, 2.0), 1.0);   // the blocker itself
    EXPECT_EQ(lit(-1.5, 0.0, 0.6, 2.0), 1.0);   // outside the map
    EXPECT_EQ(lit(-0.5, 0.0, 1.1, 2.0), 1.0);   // beyond it
    EXPECT_EQ(lit(-0.5, 0.0, -0.1, 2.0), 1.0);  // before it
    EXPECT_EQ(lit(-0.5, 0.0, 0.6, -1.0), 1.0);  // behind the light
    EXPECT_EQ(shadow_factor_2d(map, Vec4<double>{0, 0, 0, 0}, 0.0), 1.0);
}

TEST(ShadowMap, CubeDepthIsThePerspectivesOfItsFaces) {
    // A blocker at 2 m along every face's axis, seen by a perspective from 0.1 to 50 m.
    const double blocker = 50.0 / 49.9 - 50.0 * 0.1 / (49.9 * 2.0);
    const FaceDepths map{{blocker, blocker, blocker, blocker, blocker, blocker}};
    const auto lit = [&](const V3& d) { return shadow_factor_cube(map, d, 0.1, 50.0, 1e-6); };
    EXPECT_EQ(lit({0.0, -1.9, 1.0}), 1.0);
    EXPECT_EQ(lit({0.0, -2.1, 1.0}), 0.0);
    EXPECT_EQ(lit({1.9, 1.9, 1.9}), 1.0);  // 3.3 m away, but 1.9 along the axis
    EXPECT_EQ(lit({60.0, 0.0, 0.0}), 1.0);
    EXPECT_EQ(lit({0.0, 0.0, 0.0}), 1.0);
}

TEST(ShadowMap, OffsetClearsAPlaneOfItsOwnTexels) {
    // Depth grows by tan(a) metres a metre on a plane at angle a to the light; a bilinear comparison reads texels up to one
    // side away in both directions of the map.
    for (const double angle : {0.0, 0.5, 1.0, 1.5}) {
        const double texel = 0.01;
        const V3 n{std::sin(angle), 0.0, std::cos(angle)};  // the light comes from (0, 0, 1)
        const V3 moved = offset_shadow_receiver(V3{0, 0, 0}, n, std::cos(angle), texel);
        const double plane_depth_there = moved.x * std::tan(angle);  // below the light, at the new place
        const double clearance = moved.z + plane_depth_there;        // how far above the plane, along the light
        EXPECT_GE(clearance * 1.0000001, std::sqrt(2.0) * texel * std::tan(angle)) << angle;
    }
}

TEST(DepthMap, ComparesFourTexelsAndClampsToTheEdge) {
    const DepthMap map(2, 2, {0.25f, 0.75f, 0.75f, 0.25f});
    EXPECT_EQ(map(Vec2<double>{0.25, 0.25}, 0.25), 1.0);  // a texel's centre, LESS_OR_EQUAL
    EXPECT_EQ(map(Vec2<double>{0.25, 0.25}, 0.26), 0.0);
    EXPECT_EQ(map(Vec2<double>{0.5, 0.5}, 0.5), 0.5);
    EXPECT_EQ(map(Vec2<double>{0.625, 0.25}, 0.5), 0.75);
    EXPECT_EQ(map(Vec2<double>{1.0, 0.25}, 0.5), 1.0);
    EXPECT_EQ(map(Vec2<double>{-3.0, 4.0}, 0.5), 1.0);
    const Bounded between = map(Vec2<Bounded>{Bounded(0.5), Bounded(0.25)}, Bounded(0.5));
    EXPECT_NEAR(between.error, texel_step, 1e-4) << "filter weights come in steps; along the other axis both ways are half lit";
    const DepthMap corner(2, 2, {0.25f, 0.75f, 0.75f, 0.75f});
    const Bounded both = corner(Vec2<Bounded>{Bounded(0.375), Bounded(0.375)}, Bounded(0.5));
    EXPECT_NEAR(both.error, 2 * 0.75 * texel_step, 1e-4) << "steps along both axes";
}

}  // namespace
}  // namespace kiln::reference
