// Receivers in a map: ranges, slopes and a bias at which no plane shadows itself.

#include "uber/reference/shadow_receiver.h"

#include <gtest/gtest.h>

#include <random>

#include "uber/reference/lecture_shadow.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::reference {
namespace {

TEST(ShadowReceiver, KeepsVulkansConventionsAndRanges) {
    const Vec4<double> place = shadow_coordinates(Vec4<double>{1, -1, 1.5, 2});
    EXPECT_EQ(place.x, 0.75);
    EXPECT_EQ(place.y, 0.25);  // y down in both, no flip
    EXPECT_EQ(place.z, 0.75);  // no remap
    EXPECT_EQ(place.w, 1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Vec4<double>& outside : {Vec4<double>{0, 0, 0, 0},
                                        {0, 0, -1, -2},
                                        {2.1, 0, 1, 2},
                                        {0, -2.1, 1, 2},
                                        {0, 0, 2.1, 2},
                                        {0, 0, -0.1, 2},
                                        {nan, 0, 1, 2},
                                        {0, 0, 1, nan}}) {
        const Vec4<double> nowhere = shadow_coordinates(outside);
        EXPECT_EQ(nowhere.w, 0);
        EXPECT_EQ(nowhere.x, 0.5);
        EXPECT_EQ(nowhere.z, 0);
    }
}

TEST(ShadowReceiver, SlopeIsThePlanesAndBothWaysAgree) {
    // Depth of the plane at uv, by NDC = 2 uv - 1.
    const Vec4<double> plane{0.3, -0.2, 0.9, -0.4};
    const auto depth = [&](double u, double v) { return -(plane.x * (2 * u - 1) + plane.y * (2 * v - 1) + plane.w) / plane.z; };
    const Vec2<double> slope = receiver_depth_slope(plane, 64.0);
    EXPECT_NEAR(slope.x, depth(1.2, 0.5) - depth(0.2, 0.5), 1e-14);
    EXPECT_NEAR(slope.y, depth(0.1, 1.5) - depth(0.1, 0.5), 1e-14);
    const auto step = [&](double du, double dv) { return Vec3<double>{du, dv, depth(0.4 + du, 0.3 + dv) - depth(0.4, 0.3)}; };
    const Vec2<double> derived = receiver_depth_slope(step(1e-3, 2e-4), step(-3e-4, 8e-4), 64.0);
    EXPECT_NEAR(derived.x, slope.x, 1e-10);
    EXPECT_NEAR(derived.y, slope.y, 1e-10);
    EXPECT_EQ(receiver_depth_slope(Vec4<double>{1, -1, 0, 0}, 64.0).x, -64.0);  // edge on
    EXPECT_EQ(receiver_depth_slope(Vec4<double>{1, -1, 0, 0}, 64.0).y, 64.0);
    EXPECT_EQ(receiver_depth_slope(Vec3<double>{1, 2, 3}, Vec3<double>{2, 4, 6}, 64.0).x, 0.0);  // parallel
}

TEST(ShadowReceiver, HalfATexelOfSlope) {
    // Texels of 10 m / 1024 under light at 60 degrees.
    EXPECT_NEAR(receiver_depth_bias(Vec2<double>{std::tan(pi / 3), 0}, Vec2<double>{5.0 / 1024, 5.0 / 1024}, 0.0), 0.008457279,
                1e-9);
    EXPECT_EQ(receiver_depth_bias(Vec2<double>{0, 0}, Vec2<double>{1, 1}, 0.25), 0.5);
}

TEST(ShadowReceiver, TwoQuantaCoverADivisionAndNoneDoNot) {
    // The receiver is the blocker: z w / w in fp32 against z.
    std::mt19937 random(1);
    std::uniform_real_distribution<float> depth(0.0f, 1.0f), distance(0.1f, 100.0f);
    const float bias = receiver_depth_bias(Vec2<float>{0, 0}, Vec2<float>{0, 0}, 0x1p-24f);
    int unbiased = 0, biased = 0;
    constexpr int count = 1'000'000;
    for (int i = 0; i < count; ++i) {
        const float z = depth(random), w = distance(random);
        const Vec4<float> clip{0, 0, z * w, w};
        const Vec4<float> place = shadow_coordinates(clip);
        if (place.w == 0) continue;
        unbiased += z < place.z ? 1 : 0;
        biased += z < place.z - bias ? 1 : 0;
        ASSERT_EQ(shadow_factor_unbiased_lecture([&](const Vec2<float>&) { return z; }, clip), z < place.z ? 0.0f : 1.0f);
    }
    EXPECT_EQ(biased, 0);
    EXPECT_NEAR(unbiased / static_cast<double>(count), 0.0546, 0.03);
    EXPECT_GT(unbiased, count / 50);
}

TEST(ShadowReceiver, NoPlaneShadowsItself) {
    // Planes through the view of a perspective light, drawn as depth of texel centres, looked up in fp32 anywhere.
    const LightView view{1, 50, 2};
    constexpr int size = 512;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    int unbiased = 0;
    for (const double quantum : {1.0 / 65535, 0x1p-23}) {
        for (int i = 0; i < 100'000; ++i) {
            const double a = unit(random) * 2 * pi, tilt = unit(random) * 1.3;
            const Vec3<double> n{std::sin(tilt) * std::cos(a), std::sin(tilt) * std::sin(a), -std::cos(tilt)};
            const double z = 2 + 40 * unit(random), x = (unit(random) - 0.5) * z * 1.9, y = (unit(random) - 0.5) * z * 1.9;
            // World plane n.p = d in clip coordinates: x = X extent / 2, y alike, z = W, and the depth row inverted.
            const double d = n.x * x + n.y * y + n.z * z, f = view.far / (view.far - view.near);
            // z_ndc = f (1 - near / W) => 1 / W = (1 - z_ndc / f) / near; n.p / W = d / W.
            const Vec4<double> plane{n.x, n.y, d / (f * view.near), n.z - d / view.near};
            const Vec2<double> slope = receiver_depth_slope(plane, 64.0);
            const Vec4<double> exact = shadow_coordinates(view.clip(x, y, z));
            if (exact.w == 0 || std::fabs(slope.x) >= 64 || std::fabs(slope.y) >= 64) continue;
            EXPECT_NEAR(plane.x * (2 * exact.x - 1) + plane.y * (2 * exact.y - 1) + plane.z * exact.z + plane.w, 0,
                        1e-9 * (1 + std::fabs(d)));
            const float fx = static_cast<float>(x), fy = static_cast<float>(y), fz = static_cast<float>(z),
                        ff = static_cast<float>(f);
            const Vec4<float> place = shadow_coordinates(Vec4<float>{fx, fy, ff * fz - ff, fz});
            const double u = (std::floor(static_cast<double>(place.x) * size) + 0.5) / size;
            const double v = (std::floor(static_cast<double>(place.y) * size) + 0.5) / size;
            const double there = exact.z + slope.x * (u - exact.x) + slope.y * (v - exact.y);
            if (there <= 0 || there >= 1) continue;
            const double stored =
                quantum > 1e-6 ? std::round(there * 65535) / 65535 : static_cast<double>(static_cast<float>(there));
            const Vec2<float> fslope{static_cast<float>(slope.x), static_cast<float>(slope.y)};
            const float bias = receiver_depth_bias(fslope, Vec2<float>{0.5f / size, 0.5f / size}, static_cast<float>(quantum));
            unbiased += stored < static_cast<double>(place.z) ? 1 : 0;
            ASSERT_GE(stored, static_cast<double>(place.z - bias)) << x << ' ' << y << ' ' << z;
        }
    }
    EXPECT_GT(unbiased, 50'000);
}

}  // namespace
}  // namespace kiln::reference
