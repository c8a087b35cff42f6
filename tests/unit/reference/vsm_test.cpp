// Variance shadow maps: where the bound is met with equality, where it is not, and what centring is for.

#include "uber/reference/vsm.h"

#include <gtest/gtest.h>

#include <random>

#include "uber/reference/lecture_shadow.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::reference {
namespace {

constexpr double least = 1e-9;

template <class T>
Vec2<T> mean(const std::vector<T>& depths, T reference) {
    Vec2<T> sum;
    for (const T d : depths) sum = sum + shadow_moments(d, T(1), reference);
    return sum / static_cast<T>(depths.size());
}

TEST(Vsm, BoundIsExactForTwoDepths) {
    // 3 in 10 at the receiver, 10 m; 7 at 6 m. In metres, and centred in units of 20 m.
    const Vec2<double> metres{7.2, 0.3 * 100 + 0.7 * 36};
    EXPECT_NEAR(moments_variance(metres, 0.0), 3.36, 1e-13);
    EXPECT_NEAR(chebyshev_upper_bound(metres, 10.0, 0.0), 0.3, 1e-14);
    EXPECT_NEAR(vssm_blocker(metres, 10.0, 0.3), 6.0, 1e-13);
    const Vec2<double> centred = shadow_moments(10.0, 20.0, 0.4) * 0.3 + shadow_moments(6.0, 20.0, 0.4) * 0.7;
    const double p = chebyshev_upper_bound(centred, 0.1, least);
    EXPECT_NEAR(p, 0.3, 1e-6);
    EXPECT_NEAR((vssm_blocker(centred, 0.1, p) + 0.4) * 20, 6.0, 1e-5);
}

TEST(Vsm, BoundBleedsOnASpread) {
    const Vec2<double> moments{0.4, 0.16 + 0.01};
    EXPECT_NEAR(chebyshev_upper_bound(moments, 0.6, least), 0.2, 1e-6);
    EXPECT_NEAR(0.5 * std::erfc((0.6 - 0.4) / 0.1 / std::sqrt(2.0)), 0.022750, 1e-6);  // a Gaussian's share: 8.8 times less
    EXPECT_NEAR(reduce_light_bleeding(chebyshev_upper_bound(moments, 0.6, least), 0.2), 0.0, 1e-6);
    EXPECT_EQ(reduce_light_bleeding(0.1, 0.2), 0.0);
    EXPECT_EQ(reduce_light_bleeding(1.0, 0.2), 1.0);
    EXPECT_NEAR(reduce_light_bleeding(0.6, 0.2), 0.5, 1e-15);
}

TEST(Vsm, BoundIsOneTailedAndFalls) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 200; ++i) {
        std::vector<double> depths;
        for (int k = 0; k < 16; ++k) depths.push_back(unit(random) < 0.5 ? unit(random) : 0.7);
        const Vec2<double> m = mean(depths, 0.5);
        double before = 1;
        for (double t = -0.6; t < 0.6; t += 0.01) {
            const double p = chebyshev_upper_bound(m, t, least);
            int share = 0;
            for (const double d : depths) share += d - 0.5 >= t ? 1 : 0;
            EXPECT_LE(share / 16.0, p + 1e-9);  // it is a bound
            EXPECT_LE(p, before);
            EXPECT_GE(p, 0);
            if (t <= m.x) {
                EXPECT_EQ(p, 1);
            }
            before = p;
        }
    }
}

TEST(Vsm, IsFiniteWhereTheLecturesFormIsNot) {
    const Vec2<double> flat{0.5, 0.25};
    EXPECT_TRUE(std::isnan(chebyshev_lecture(flat, 0.5)));
    EXPECT_EQ(chebyshev_upper_bound(flat, 0.5, least), 1.0);
    EXPECT_NEAR(chebyshev_lecture(Vec2<double>{0.4, 0.17}, 0.2), 0.2, 1e-12);  // before the mean as dark as behind it
    EXPECT_EQ(chebyshev_upper_bound(Vec2<double>{0.4, 0.17}, 0.2, least), 1.0);
    EXPECT_EQ(vssm_blocker(flat, 0.6, 1.0), 0.6);
    EXPECT_EQ(vssm_blocker(flat, 0.6, 0.0), 0.5);
    EXPECT_TRUE(std::isfinite(vssm_blocker(Vec2<float>{0.4f, 0.17f}, 0.6f, 0.99899f)));
}

TEST(Vsm, CentredMomentsKeepTheirDigits) {
    // Depths z0 - d and z0 + d, half and half: variance d^2. A moment is off by 3 roundings at most (square, sum, square of
    // the mean), each half a unit of fp32 relative to the square itself: (z0)^2 for plain moments, (z0 - reference)^2 for
    // centred ones.
    for (const auto& [z0, d, reference] : {std::tuple{0.99f, 1e-4f, 0.985f}, std::tuple{0.9f, 1e-3f, 0.92f}}) {
        const std::vector<float> depths{z0 - d, z0 + d};
        const double a = static_cast<double>(depths[0]), b = static_cast<double>(depths[1]), exact = (b - a) * (b - a) / 4;
        const double centred = static_cast<double>(moments_variance(mean(depths, reference), 0.0f));
        const double q = std::fabs(b - static_cast<double>(reference)) + std::fabs(b - a);
        EXPECT_NEAR(centred, exact, 3 * 0x1p-24 * q * q);
        EXPECT_NEAR(centred, exact, 1e-3 * exact);
        const Vec2<float> plain = (shadow_moments_lecture(depths[0]) + shadow_moments_lecture(depths[1])) / 2.0f;
        const double lecture = static_cast<double>(moments_variance_lecture(plain));
        EXPECT_NEAR(lecture, exact, 3 * 0x1p-24);
        // Both moments are in [1/2, 1): their difference is a multiple of 2^-24, and 1e-8 is none.
        EXPECT_EQ(std::remainder(lecture, 0x1p-24), 0);
        EXPECT_GT(std::fabs(lecture - exact), 0.01 * exact);
    }
    const std::vector<float> flat{0.99f - 1e-4f, 0.99f + 1e-4f};
    const Vec2<float> plain = (shadow_moments_lecture(flat[0]) + shadow_moments_lecture(flat[1])) / 2.0f;
    EXPECT_GE(std::fabs(moments_variance_lecture(plain) - 1e-8f), 0.9e-8f);  // nothing is left
}

TEST(Vsm, PlainMomentsOfAPlaneAreOftenNegative) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> depth(0.95f, 0.999f), slope(-1e-5f, 1e-5f);
    int negative = 0;
    double lowest = 0;
    constexpr int count = 20'000;
    for (int i = 0; i < count; ++i) {
        const float z = depth(random), s = slope(random);
        Vec2<float> plain, centred;
        for (int k = -2; k <= 2; ++k) {
            const float d = z + s * static_cast<float>(k);
            plain = plain + shadow_moments_lecture(d) / 5.0f;
            centred = centred + shadow_moments(d, 1.0f, 0.97f) / 5.0f;
        }
        const float v = moments_variance_lecture(plain);
        negative += v < 0 ? 1 : 0;
        lowest = std::min(lowest, static_cast<double>(v));
        ASSERT_GE(moments_variance(centred, 1e-9f), 1e-9f);
        const double p = static_cast<double>(chebyshev_upper_bound(centred, z - 0.97f, 1e-9f));
        ASSERT_TRUE(p >= 0 && p <= 1);
    }
    EXPECT_GT(negative, count / 4);
    EXPECT_LT(lowest, -1e-7);
    EXPECT_GT(lowest, -2e-6);  // so 2e-6 is enough as the least variance of plain moments
}

TEST(Vsm, SlantedTexelsHaveTheVarianceOfAPlane) {
    // 64 x 64 points of a texel crossed by a plane.
    const Vec2<double> g{0.03, -0.02};
    double sum = 0, squares = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const double q = g.x * ((x + 0.5) / 64 - 0.5) + g.y * ((y + 0.5) / 64 - 0.5);
            sum += q / 4096, squares += q * q / 4096;
        }
    const Vec2<double> m = shadow_moments(0.5, 1.0, 0.5, g);
    EXPECT_NEAR(moments_variance(m, 0.0), squares - sum * sum, 1e-3 * m.y);
}

struct Vssm {
    LightView view{1, 20, 2};
    ShadowScene scene;
    double reference = 0.35;
    MomentMap map;
    explicit Vssm(const ShadowScene& s) : scene(s), map(moment_map(distance_map(s, view, 256), 256, view.far, reference)) {}
    double operator()(double x, double y, double bleeding = 0) const {
        const auto average = [&](const Vec2<double>& c, const Vec2<double>& w) { return map.average(c, w); };
        return vssm_factor(average, view.clip(x, y, scene.receiver), scene.light, view.near, view.far, view.extent, 1.0 / 256,
                           reference, least, bleeding);
    }
};

TEST(Vssm, IsExactAlongAnEdge) {
    // Two depths: the bound is equality, the blocker's distance exact, the box's share of texels linear.
    for (const double blocker : {3.0, 6.0, 8.0}) {
        const Vssm vssm(edge_scene(blocker));
        const double w = edge_penumbra(10, blocker, 1);
        for (int i = 0; i <= 100; ++i) {
            const double x = (i / 100.0 - 0.5) * 1.5 * w;
            // Least variance 1e-9 against a squared step of ((10 - 8) / 20)^2, twice: in the width and in the share.
            EXPECT_NEAR(vssm(x, 0.1), square_light_edge(x, w), 1e-6) << blocker << ' ' << x;
        }
    }
}

TEST(Vssm, BleedsUnderTwoBlockers) {
    const Vssm vssm(stacked_scene());
    EXPECT_EQ(visible_share(vssm.scene, 0, 0), 0.0);
    // Half the box at 3 m, half at 9: s^2 / (s^2 + (10 - 6)^2) with s = 3.
    EXPECT_NEAR(vssm(0, 0), 0.36, 1e-6);
    EXPECT_NEAR(vssm(0, 0, 0.4), 0.0, 1e-12);
    EXPECT_LT(vssm(-4, 0), 1e-6);  // far from the edge one depth is left, and it is dark
}

TEST(Vssm, ClampsWherePCannotTell) {
    const auto flat = [](const Vec2<double>&, const Vec2<double>&) { return Vec2<double>{0.15, 0.0225}; };
    EXPECT_EQ(vssm_factor(flat, Vec4<double>{0, 0, 5, 10}, 1.0, 1.0, 20.0, 2.0, 1e-3, 0.35, least, 0.0), 1.0);  // t is the mean
    EXPECT_EQ(vssm_factor(flat, Vec4<double>{0, 0, 5, -1}, 1.0, 1.0, 20.0, 2.0, 1e-3, 0.35, least, 0.0), 1.0);
}

}  // namespace
}  // namespace kiln::reference
