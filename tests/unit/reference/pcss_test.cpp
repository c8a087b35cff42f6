// PCSS against the closed form that it should reproduce, at the ends of its parameters, and what the lecture's formula does
// there.

#include "uber/reference/pcss.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "uber/reference/lecture_shadow.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::reference {
namespace {

const LightView view{1, 20, 2};

// The scene's map without texels.
struct Maps {
    ShadowScene scene;
    auto depth() const {
        return [this](const Vec2<double>& uv) { return view.depth(nearest_distance(scene, view, uv)); };
    }
    auto compare() const {
        return
            [this](const Vec2<double>& uv, double z) { return z <= view.depth(nearest_distance(scene, view, uv)) ? 1.0 : 0.0; };
    }
    double pcss(double x, double y, const PcssTaps& taps, const Vec2<double>& jitter = {}) const {
        return pcss_factor(depth(), compare(), view.clip(x, y, scene.receiver), Vec2<double>{}, 1e-9, scene.light, view.near,
                           view.far, view.extent, 1e-6, jitter, taps);
    }
};

TEST(Pcss, PenumbraHasTheKnownWidths) {
    EXPECT_NEAR(pcss_penumbra_width(10.0, 6.0, 1.5, 0.0, 1e9), 1.0, 1e-15);
    EXPECT_NEAR(pcss_penumbra_width(10.0, 9.9, 1.5, 0.0, 1e9), 0.0151515152, 1e-10);
    EXPECT_NEAR(pcss_penumbra_width_directional(10.0, 6.0, 0.0093, 0.0, 1e9), 0.0372, 1e-15);
    EXPECT_NEAR(pcss_search_width(10.0, 1.0, 1.5), 1.35, 1e-15);
    EXPECT_EQ(pcss_search_width(0.5, 1.0, 1.5), 0.0);
    EXPECT_NEAR(light_distance(view.depth(7.0), view.near, view.far), 7.0, 1e-13);
    EXPECT_NEAR(light_distance(1.0, view.near, view.far), 20.0, 1e-12);
    EXPECT_EQ(map_distance(0.25, 0.0, 40.0), 10.0);
}

TEST(Pcss, PenumbraIsBoundedWhereTheLecturesIsNot) {
    EXPECT_NEAR(pcss_penumbra_width_lecture(10.0, 1e-3, 1.5), 14998.5, 1e-9);
    EXPECT_LT(pcss_penumbra_width_lecture(5.0, 6.0, 1.5), 0.0);
    EXPECT_TRUE(std::isinf(pcss_penumbra_width_lecture(10.0, 0.0, 1.5)));
    EXPECT_TRUE(std::isnan(pcss_mean_blocker_lecture(0.0, 0.0)));
    EXPECT_EQ(pcss_penumbra_width(10.0, 1e-3, 1.5, 0.01, 4.0), 4.0);
    EXPECT_EQ(pcss_penumbra_width(10.0, 0.0, 1.5, 0.01, 4.0), 4.0);
    EXPECT_EQ(pcss_penumbra_width(5.0, 6.0, 1.5, 0.01, 4.0), 0.01);
}

TEST(Pcss, LatticeIsStratifiedOnBothAxes) {
    for (int n = 4; n <= 256; ++n)
        for (const Vec2<double>& jitter : {Vec2<double>{}, {0.3, 0.9}}) {
            std::set<long> columns, rows;
            for (int i = 0; i < n; ++i) {
                const Vec2<double> p = pcss_tap(i, n, jitter);
                EXPECT_LE(std::fabs(p.x), 0.5);
                EXPECT_LE(std::fabs(p.y), 0.5);
                // Rounding at the seam of the torus and at cells' borders, which a jitter of 0.3 n or 0.9 n may meet.
                columns.insert(static_cast<long>(std::floor((p.x + 0.5) * n + 1e-6)) % n);
                rows.insert(static_cast<long>(std::floor((p.y + 0.5) * n + 1e-6)) % n);
            }
            EXPECT_EQ(columns.size(), static_cast<size_t>(n)) << n;
            EXPECT_EQ(rows.size(), static_cast<size_t>(n)) << n;
        }
}

TEST(Pcss, IsExactAlongAnEdgeParallelToTheLight) {
    // The search finds the blocker's distance and no other, so the width is right and only the taps' levels are left: half of
    // 1 / n, a whole one where the lattice is shifted.
    for (const double blocker : {3.0, 6.0, 9.0})
        for (const int n : {6, 16, 25, 32, 64, 120}) {
            const Maps maps{edge_scene(blocker)};
            const double w = edge_penumbra(10, blocker, maps.scene.light);
            double worst = 0, shifted = 0;
            for (int i = 0; i <= 400; ++i) {
                const double x = (i / 400.0 - 0.5) * 1.5 * w + 1e-7;
                worst = std::max(worst, std::fabs(maps.pcss(x, 0.2, {n, n, false}) - square_light_edge(x, w)));
                shifted = std::max(shifted, std::fabs(maps.pcss(x, 0.2, {n, n, false}, {0.37, 0.61}) - square_light_edge(x, w)));
            }
            EXPECT_LE(worst, 0.5 / n + 1e-6) << blocker << ' ' << n;
            EXPECT_GE(worst, 0.4 / n) << blocker << ' ' << n;
            EXPECT_LE(shifted, 1.0 / n + 1e-6) << blocker << ' ' << n;
        }
}

TEST(Pcss, FollowsARoundLight) {
    // A chord crosses about 2 sqrt(n / pi) of n equal cells of the disk and misjudges half of each at worst.
    for (const int n : {16, 32, 64}) {
        Maps maps{edge_scene(6)};
        maps.scene.disk = true;
        const double w = edge_penumbra(10, 6, maps.scene.light);
        for (int i = 0; i <= 100; ++i) {
            const double x = (i / 100.0 - 0.5) * 1.2 * w + 1e-7;
            EXPECT_NEAR(maps.pcss(x, 0.1, {n, n, true}), disk_light_edge(2 * x / w), std::sqrt(n / pi) / n + 1e-6)
                << n << ' ' << x;
        }
    }
}

TEST(Pcss, StaysWithinItsBoundsAnywhere) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto noise = [&](const Vec2<double>&) { return unit(random); };
    const auto compare = [&](const Vec2<double>&, double z) { return z <= unit(random) ? 1.0 : 0.0; };
    const auto empty = [](const Vec2<double>&) { return 1.0; };
    const auto on_light = [](const Vec2<double>&) { return 0.0; };
    for (int i = 0; i < 3000; ++i) {
        const double z = 0.5 + 25 * unit(random);
        const Vec4<double> clip = view.clip((unit(random) - 0.5) * 3 * z, (unit(random) - 0.5) * 3 * z, z);
        const auto factor = [&](const auto& map) {
            return pcss_factor(map, compare, clip, Vec2<double>{}, 1e-6, 3 * unit(random), view.near, view.far, view.extent, 1e-3,
                               {}, {16, 16, false});
        };
        for (const double lit : {factor(noise), factor(on_light)}) {
            ASSERT_GE(lit, 0.0);
            ASSERT_LE(lit, 1.0);
        }
        ASSERT_EQ(factor(empty), 1.0);
    }
    EXPECT_EQ(pcss_factor(on_light, compare, Vec4<double>{0, 0, 1, -1}, Vec2<double>{}, 0.0, 1.0, 1.0, 20.0, 2.0, 1e-3, {}), 1.0);
}

TEST(Pcss, DirectionalLightIsTheLimitOfAFarOne) {
    // An orthographic map over 40 m, 10 m wide; the edge is 8 m above the receiver at 30 m.
    const double angular_size = 0.05, w = angular_size * 8;
    const auto depth = [](const Vec2<double>& uv) { return uv.x < 0.5 ? 22.0 / 40 : 30.0 / 40; };
    const auto compare = [&](const Vec2<double>& uv, double z) { return z <= depth(uv) ? 1.0 : 0.0; };
    for (int i = 0; i <= 100; ++i) {
        const double x = (i / 100.0 - 0.5) * 1.5 * w + 1e-7;
        const Vec4<double> clip{2 * x / 10, 0, 30.0 / 40, 1};
        const double lit =
            pcss_factor_directional(depth, compare, clip, Vec2<double>{}, 1e-9, angular_size, 40.0, 10.0, 1e-6, {});
        EXPECT_NEAR(lit, square_light_edge(x, w), 0.5 / 32 + 1e-6);
    }
}

// Root mean square error over the penumbra of a scene, along a line.
template <class F>
double error_in_penumbra(const ShadowScene& scene, F lit) {
    double sum = 0;
    int count = 0;
    for (int i = 0; i <= 300; ++i) {
        const double x = (i / 300.0 - 0.5) * 10, y = 0.3, truth = visible_share(scene, x, y);
        if (truth <= 0 || truth >= 1) continue;
        const double e = lit(x, y) - truth;
        sum += e * e;
        ++count;
    }
    EXPECT_GT(count, 5);
    return std::sqrt(sum / count);
}

TEST(Pcss, IsNearerToTheTruthThanAHardEdgeAtEveryHeight) {
    for (const ShadowScene& scene : {square_scene(3), square_scene(6), square_scene(9), fence_scene()}) {
        const Maps maps{scene};
        const auto hard = [&](double x, double y) {
            const Vec4<double> at = shadow_coordinates(view.clip(x, y, scene.receiver));
            return maps.compare()(at.xy(), at.z - 1e-9);
        };
        const double of_hard = error_in_penumbra(scene, hard);
        const double of_pcss = error_in_penumbra(scene, [&](double x, double y) { return maps.pcss(x, y, {64, 64, false}); });
        EXPECT_LT(of_pcss, of_hard / 2);
    }
}

}  // namespace
}  // namespace kiln::reference
