// Cascades: where they split, that each depth has one slice, and that edges do not swim.

#include "uber/reference/cascades.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln::reference {
namespace {

TEST(Cascades, SplitsHaveTheKnownValues) {
    const auto expect = [](double lambda, std::vector<double> ends) {
        const std::vector<double> got = practical_splits(0.1, 100, 4, lambda);
        ASSERT_EQ(got.size(), 4u);
        for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(got[i], ends[i], 1e-8) << lambda;
        EXPECT_EQ(got[3], 100.0);
    };
    expect(0, {25.075, 50.05, 75.025});
    expect(0.5, {12.818670663, 26.606138830, 46.403897050});
    expect(0.75, {6.690505994, 14.884208245, 32.093345575});
    expect(1, {0.562341325, 3.162277660, 17.782794100});
    const std::vector<double> three = practical_splits(0.5, 200, 3, 0.6);
    EXPECT_NEAR(three[0], 29.010418899, 1e-8);
    EXPECT_NEAR(three[1], 69.686505700, 1e-8);
}

TEST(Cascades, EveryFloatHasOneSlice) {
    const std::vector<double> splits = practical_splits(0.1, 100, 4, 0.75);
    const Vec4<float> ends{static_cast<float>(splits[0]), static_cast<float>(splits[1]), static_cast<float>(splits[2]), 100.0f};
    const float bounds[] = {-INFINITY, ends.x, ends.y, ends.z, ends.w};
    const auto expect = [&](float z) {
        for (int count = 1; count <= 4; ++count) {
            int holding = -1, number = 0;
            for (int i = 0; i < count; ++i) {
                const bool in = z >= bounds[i] && (i + 1 < count ? z < bounds[i + 1] : z <= bounds[i + 1]);
                if (in) holding = i, ++number;
            }
            ASSERT_LE(number, 1);
            ASSERT_EQ(cascade_index(z, ends, count), holding) << static_cast<double>(z) << ' ' << count;
        }
    };
    for (const float z : bounds)
        for (const float to : {-INFINITY, INFINITY}) {
            expect(z);
            expect(std::nextafter(z, to));
            expect(std::nextafter(std::nextafter(z, to), to));
        }
    std::mt19937 random(6);
    std::uniform_real_distribution<float> depth(-1.0f, 120.0f);
    for (int i = 0; i < 100'000; ++i) expect(depth(random));
    expect(0.0f);
    expect(INFINITY);
    expect(-INFINITY);
    EXPECT_EQ(cascade_index(std::nanf(""), ends, 4), -1);
}

TEST(Cascades, BlendIsContinuousAndSumsToOne) {
    const Vec4<double> ends{10, 30, 60, 100};
    for (const double band : {0.05, 0.1, 1.0})
        for (int count = 1; count <= 4; ++count) {
            double before[4] = {1, 0, 0, 0}, lit_before = 0;
            constexpr double step = 1e-3;
            for (double z = step / 2; z <= 101; z += step) {
                const CascadeChoice<double> c = choose_cascade(z, 0.0, ends, count, band);
                double now[4] = {0, 0, 0, 0}, lit = 1;
                if (c.index >= 0) {
                    now[c.index] = 1 - c.blend;
                    if (c.next >= 0) now[c.next] = c.blend;
                    lit = c.next >= 0 ? 0 : c.blend;  // the last fades into light
                }
                EXPECT_NEAR(now[0] + now[1] + now[2] + now[3] + lit, 1, 1e-12);
                // The steepest band is the first: 1 / (band * 10) a metre; band 1 begins with a corner, not with a step.
                for (int i = 0; i < 4; ++i) {
                    EXPECT_NEAR(now[i], before[i], 1.01 * step / (band * 10)) << z << ' ' << count << ' ' << band;
                    before[i] = now[i];
                }
                EXPECT_NEAR(lit, lit_before, 1.01 * step / (band * 10));
                lit_before = lit;
            }
        }
    EXPECT_EQ(cascade_blend(9.0, 0.0, 10.0, 0.1), 0.0);
    EXPECT_EQ(cascade_blend(10.0, 0.0, 10.0, 0.1), 1.0);
    // No band: a step at the end.
    EXPECT_EQ(cascade_blend(std::nextafter(10.0, 0.0), 0.0, 10.0, 0.0), 0.0);
    EXPECT_EQ(cascade_blend(10.0, 0.0, 10.0, 0.0), 0.0);
    EXPECT_EQ(cascade_blend(10.0, 10.0, 10.0, 0.1), 0.0);
}

struct Camera {
    Vec3<double> position, right, up, forward;
    Vec3<double> at(double x, double y, double depth) const { return position + right * x + up * y + forward * depth; }
};
Camera camera(const Vec3<double>& position, double yaw, double pitch) {
    const Vec3<double> forward{std::cos(pitch) * std::sin(yaw), std::sin(pitch), std::cos(pitch) * std::cos(yaw)};
    const Vec3<double> right = normalize(cross(Vec3<double>{0, 1, 0}, forward));
    return {position, right, cross(forward, right), forward};
}

TEST(Cascades, SphereHoldsTheSliceAndIsTheSmallest) {
    for (const auto& [start, end] : {std::pair{0.1, 5.0}, {5.0, 6.0}, {20.0, 100.0}}) {
        const double tx = 0.9, ty = 0.5;
        const BoundingSphere sphere = slice_sphere(start, end, tx, ty);
        const auto reach = [&, ends = std::array{start, end}](double centre) {
            double r = 0;
            for (const double z : ends) r = std::max(r, std::sqrt((z - centre) * (z - centre) + z * z * (tx * tx + ty * ty)));
            return r;
        };
        EXPECT_NEAR(reach(sphere.depth), sphere.radius, 1e-12 * end);
        for (const double d : {-0.01, 0.01}) EXPECT_GT(reach(sphere.depth + d * end), sphere.radius);
    }
}

TEST(Cascades, MapHoldsTheSliceAndMovesByWholeTexels) {
    const LightAxes light = light_axes({0.3, -0.8, 0.4});
    const double tx = 0.9, ty = 0.5, start = 3, end = 20;
    const BoundingSphere sphere = slice_sphere(start, end, tx, ty);
    constexpr int size = 512;
    const Vec3<double> landmark{3.21, -1.5, 8.7};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    double first[2]{};
    int moved = 0;
    for (int i = 0; i < 1000; ++i) {
        const Camera c = camera({50 * unit(random), 5 * unit(random), 50 * unit(random)}, 3 * unit(random), unit(random));
        const CascadeFit fit = fit_cascade(c.at(0, 0, sphere.depth), sphere.radius, light, size, 100);
        for (const double z : {start, end})
            for (const double sx : {-tx, tx})
                for (const double sy : {-ty, ty}) {
                    const Vec3<double> corner = c.at(sx * z, sy * z, z);
                    const Vec4<double> place =
                        shadow_coordinates(fit.clip_of_world * Vec4<double>{corner.x, corner.y, corner.z, 1});
                    ASSERT_EQ(place.w, 1);
                    ASSERT_GE(place.z * fit.range, 100 - 1e-9);  // what is up to 100 m nearer to the light casts as well
                }
        // A standing point in texels: whole steps only.
        const Vec4<double> clip = fit.clip_of_world * Vec4<double>{landmark.x, landmark.y, landmark.z, 1};
        const double texels[] = {(clip.x * 0.5 + 0.5) * size, (clip.y * 0.5 + 0.5) * size};
        for (int k = 0; k < 2; ++k) {
            if (i == 0) first[k] = texels[k];
            const double step = texels[k] - first[k];
            moved += std::fabs(step) > 0.5 ? 1 : 0;
            ASSERT_NEAR(step, std::round(step), 1e-8);
        }
    }
    EXPECT_GT(moved, 1000);
}

TEST(Cascades, TexelsGrowWithTheRatioOfASlicesEnds) {
    // Seen from the camera a texel is widest where its slice begins. A slice that is wider than long has radius k end, k the
    // tangent of half the diagonal field of view, so that logarithmic splits give 2 k (f/n)^(1/m) / (size - 1) to every slice;
    // more slices shrink the ratio's root, not the error in proportion to their number.
    const double tx = 0.9, ty = 0.5, near = 1, far = 1000, k = std::sqrt(tx * tx + ty * ty);
    constexpr int size = 2048;
    const LightAxes light = light_axes({0.3, -0.8, 0.4});
    const auto widest = [&](int count, double lambda) {
        double start = near, worst = 0;
        for (const double end : practical_splits(near, far, count, lambda)) {
            const BoundingSphere sphere = slice_sphere(start, end, tx, ty);
            worst = std::max(worst, fit_cascade({0, 0, sphere.depth}, sphere.radius, light, size, 100).texel / start);
            start = end;
        }
        return worst;
    };
    for (int count = 1; count <= 4; ++count)
        EXPECT_NEAR(widest(count, 1), 2 * k * std::pow(far / near, 1.0 / count) / (size - 1), 1e-12) << count;
    for (const double lambda : {0.0, 0.5, 0.75})
        for (int count = 2; count <= 4; ++count) {
            EXPECT_LT(widest(count, lambda), widest(count - 1, lambda)) << lambda;
            EXPECT_GT(widest(count, lambda), widest(count, 1)) << lambda;
        }
}

TEST(Cascades, LightAxesAreAtRightAnglesWhereverLightComesFrom) {
    for (const Vec3<double>& d : {Vec3<double>{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {0.1, -5, 0.1}}) {
        const LightAxes a = light_axes(d);
        EXPECT_NEAR(dot(a.right, a.forward), 0, 1e-15);
        EXPECT_NEAR(length(cross(a.right, a.down) - a.forward), 0, 1e-14);
        EXPECT_NEAR(length(a.down), 1, 1e-15);
    }
}

TEST(Cascades, OnlyChosenLayersAreSampled) {
    // Layers lit 0, 1, 0, 1; a matrix that leaves everything in the middle of the map.
    int samples = 0;
    const auto maps = [&](int layer, const Vec2<double>&, double) { return ++samples, layer % 2 == 1 ? 1.0 : 0.0; };
    std::array<Mat4<double>, 4> middle;
    for (Mat4<double>& m : middle) m = {{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0.5, 1}}};
    const Vec4<double> ends{10, 30, 60, 100};
    const auto lit = [&](double depth) {
        samples = 0;
        return cascaded_shadow(maps, middle, Vec4<double>{}, Vec3<double>{}, choose_cascade(depth, 0.0, ends, 4, 0.1));
    };
    EXPECT_EQ(lit(5), 0);
    EXPECT_EQ(samples, 1);
    EXPECT_NEAR(lit(9.25), 0.25, 1e-12);
    EXPECT_EQ(samples, 2);
    EXPECT_EQ(lit(10), 1);
    EXPECT_EQ(samples, 1);
    EXPECT_NEAR(lit(29), 0.5, 1e-12);
    EXPECT_EQ(lit(101), 1);
    EXPECT_EQ(samples, 0);
}

}  // namespace
}  // namespace kiln::reference
