// The ground truths against each other: polygons against closed forms and rays.

#include "uber/reference/shadow_truth.h"

#include <gtest/gtest.h>

#include "uber/reference/lecture_shadow.h"

namespace kiln::reference {
namespace {

TEST(ShadowTruth, PolygonsGiveTheClosedFormsOfAnEdge) {
    for (const double blocker : {1.0, 5.0, 9.5}) {
        ShadowScene scene = edge_scene(blocker);
        const double w = edge_penumbra(scene.receiver, blocker, scene.light);
        for (double u = -1.2; u <= 1.2; u += 0.05) {
            scene.disk = false;
            EXPECT_NEAR(visible_share(scene, u * w / 2, 0.3), square_light_edge(u * w / 2, w), 1e-12) << u;
            scene.disk = true;
            EXPECT_NEAR(visible_share(scene, u * w / 2, 0.3), disk_light_edge(u), 2e-6) << u;
        }
    }
}

TEST(ShadowTruth, DiskAndSquareDifferByTheKnownAmount) {
    double worst = 0, at = 0;
    for (int i = 0; i <= 100'000; ++i) {
        const double u = i / 100'000.0, d = disk_light_edge(u) - square_light_edge(u, 2);
        if (d > worst) worst = d, at = u;
    }
    EXPECT_NEAR(worst, 0.057711, 1e-6);
    EXPECT_NEAR(at, 0.619, 1e-3);
}

TEST(ShadowTruth, RaysAgreeWithinTheirStandardError) {
    for (const ShadowScene& scene : {square_scene(3), square_scene(6), square_scene(9), stacked_scene(), fence_scene()})
        for (const bool disk : {false, true}) {
            ShadowScene s = scene;
            s.disk = disk;
            for (const double x : {-1.0, 0.3, 1.7, 2.1, 3.3}) {
                const Estimate rays = visible_share_by_rays(s, x, 0.4, 64, 11);
                EXPECT_LE(rays.standard_error, 0.0079);
                EXPECT_NEAR(visible_share(s, x, 0.4), rays.mean, 4 * rays.standard_error) << x;
            }
        }
}

TEST(ShadowTruth, OverlapsCountOnce) {
    const ShadowScene twice{{{{-100, 0, -100, 100}, 5}, {{-100, 0, -100, 100}, 5}}, 10, 1, false};
    EXPECT_NEAR(visible_share(twice, 0, 0), 0.5, 1e-12);
    EXPECT_EQ(visible_share(stacked_scene(), 0.2, 0), 0.0);
    EXPECT_EQ(visible_share({{}, 10, 1, false}, 0, 0), 1.0);
    // A fence of half-open slats, seen through a light of exactly two periods: half of it.
    ShadowScene fence = fence_scene();
    fence.light = 1.0 / (1 - 6.0 / 10) * 1.0;  // two slats and two gaps of 0.25 at 6 m, back in the light's plane
    EXPECT_NEAR(visible_share(fence, 0.123, 0), 0.5, 1e-12);
}

TEST(ShadowTruth, MapsShowWhatTheLightSees) {
    const LightView view{1, 20, 2};
    const std::vector<double> map = distance_map(square_scene(5), view, 100);
    EXPECT_EQ(map[50 * 100 + 50], 5);
    EXPECT_EQ(map[0], 10);
    int blocked = 0;
    for (const double d : map) blocked += d < 10 ? 1 : 0;
    EXPECT_EQ(blocked, 20 * 20);  // 2 m of 10 m each way at 5 m
    EXPECT_NEAR(view.depth(1), 0, 1e-15);
    EXPECT_NEAR(view.depth(20), 1, 1e-15);
    const Vec4<double> place = shadow_coordinates(view.clip(1, -2, 8));
    EXPECT_NEAR(place.z, view.depth(8), 1e-15);
    EXPECT_NEAR(place.x, 0.5 + 1.0 / 8 / view.extent, 1e-15);
}

TEST(ShadowTruth, LecturesRemapShadowsEverything) {
    // Even the lit receiver that the map itself holds.
    const LightView view{1, 20, 2};
    const ShadowScene open{{}, 10, 1, false};
    const auto depth = [&](const Vec2<double>& uv) { return view.depth(nearest_distance(open, view, uv)); };
    EXPECT_EQ(visible_share(open, 0.5, 0.5), 1.0);
    EXPECT_EQ(shadow_factor_lecture(depth, view.clip(0.5, 0.5, 10)), 0.0);
    EXPECT_EQ(shadow_factor_lecture(depth, view.clip(0.5, 0.5, 2)),
              0.0 + (depth({0.5, 0.5}) >= view.depth(2) * 0.5 + 0.5 ? 1.0 : 0.0));
    // w < 0 mirrors the look-up: the point behind the light is judged by a texel that it does not project to.
    const auto left = [](const Vec2<double>& uv) { return uv.x < 0.5 ? 0.0 : 1.0; };
    EXPECT_EQ(shadow_factor_unbiased_lecture(left, Vec4<double>{1, 0, -1, -2}), 0.0);
    EXPECT_EQ(shadow_coordinates(Vec4<double>{1, 0, -1, -2}).w, 0.0);
}

}  // namespace
}  // namespace kiln::reference
