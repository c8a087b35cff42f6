// Percentage-closer filters on an edge of no width, against the ramps that a box and a disk make.

#include "uber/reference/pcf.h"

#include <gtest/gtest.h>

#include <set>

#include "uber/reference/shadow_truth.h"

namespace kiln::reference {
namespace {

// Blocked at depth 0.3 left of the middle.
double edge(const Vec2<double>& uv, double depth) { return uv.x < 0.5 && depth > 0.3 ? 0 : 1; }

TEST(Pcf, BoxDeviatesFromTheRampByHalfALevel) {
    const double width = 0.25;
    for (const int n : {3, 5, 7}) {
        double worst = 0;
        std::set<long> levels;
        for (int i = 0; i <= 20'000; ++i) {
            const double x = (i / 20'000.0 - 0.5) * 1.2 * width + 1e-7;
            const double lit =
                pcf_box(edge, Vec3<double>{0.5 + x, 0.5, 0.6}, Vec2<double>{0, 0}, 0.0, Vec2<double>{width, width}, n);
            worst = std::max(worst, std::fabs(lit - square_light_edge(x, width)));
            levels.insert(std::lround(lit * n));
            EXPECT_NEAR(lit * n, std::round(lit * n), 1e-9);
        }
        EXPECT_LE(worst, 0.5 / n + 1e-9) << n;
        EXPECT_GE(worst, 0.5 / n - 1e-3) << n;
        EXPECT_EQ(levels.size(), static_cast<size_t>(n + 1));
    }
}

TEST(Pcf, SlopedReceiverNeitherShadowsItselfNorNeedsBias) {
    const Vec2<double> slope{0.7, -0.3};
    const auto plane = [&](const Vec2<double>& uv, double depth) {
        return depth <= 0.5 + dot(slope, uv - Vec2<double>{0.5, 0.5}) + 1e-12 ? 1.0 : 0.0;
    };
    const Vec3<double> place{0.5, 0.5, 0.5};
    const Vec2<double> width{0.2, 0.2}, flat{0, 0};
    EXPECT_EQ(pcf_box(plane, place, slope, 0.0, width, 7), 1.0);
    EXPECT_EQ(pcf_poisson_32(plane, place, slope, 0.0, width, 0.3), 1.0);
    EXPECT_LT(pcf_box(plane, place, flat, 0.0, width, 7), 0.6);  // half of the taps lie behind the plane
}

TEST(Pcf, OutsideTheMapIsLit) {
    const auto blocked = [](const Vec2<double>&, double) { return 0.0; };
    const Vec2<double> flat{0, 0}, width{0.5, 0.5};
    EXPECT_NEAR(pcf_box(blocked, Vec3<double>{0, 0.5, 0.5}, flat, 0.0, width, 4), 0.5, 1e-12);
    EXPECT_EQ(pcf_box(blocked, Vec3<double>{0.5, 0.5, 0.5}, flat, 0.0, width, 4), 0.0);
    EXPECT_EQ(shadow_tap(blocked, Vec3<double>{0.5, 0.5, 1.0}, Vec2<double>{1, 0}, 0.0, Vec2<double>{0.1, 0}), 1.0);
}

template <int n>
void expect_disk(const Vec2<double> (&disk)[n], double apart) {
    Vec2<double> mean;
    double squares = 0, nearest = 2;
    std::vector<double> radii;
    for (int i = 0; i < n; ++i) {
        mean = mean + disk[i] / static_cast<double>(n);
        squares += dot(disk[i], disk[i]) / n;
        radii.push_back(length(disk[i]));
        EXPECT_LE(radii.back(), 1);
        for (int j = 0; j < i; ++j) nearest = std::min(nearest, length(disk[i] - disk[j]));
    }
    EXPECT_NEAR(mean.x, 0, 1e-4);
    EXPECT_NEAR(mean.y, 0, 1e-4);
    EXPECT_NEAR(squares, 0.5, 1e-4);
    EXPECT_GE(nearest, apart);
    // Over all turns the filter is a mix of circles: against the disk's chord it is off by no more than half the largest
    // difference of the radii's distribution from r^2, since a circle's share beyond a chord varies by 1/2 over r.
    std::sort(radii.begin(), radii.end());
    double discrepancy = 0;
    for (int i = 0; i < n; ++i) {
        const double area = radii[static_cast<size_t>(i)] * radii[static_cast<size_t>(i)];
        discrepancy = std::max({discrepancy, std::fabs(area - i / static_cast<double>(n)), std::fabs(area - (i + 1.0) / n)});
    }
    EXPECT_LT(discrepancy, 0.4);
    for (double u = -0.95; u < 1; u += 0.1) {
        double sum = 0;
        constexpr int turns = 400;
        for (int i = 0; i < turns; ++i)
            sum += pcf_poisson(edge, Vec3<double>{0.5 + 0.1 * u, 0.5, 0.6}, Vec2<double>{0, 0}, 0.0, Vec2<double>{0.1, 0.1},
                               (i + 0.5) / turns, disk);
        EXPECT_NEAR(sum / turns, disk_light_edge(u), discrepancy / 2 + 1.0 / turns) << n << ' ' << u;
    }
}

TEST(Pcf, PoissonDisksAreSpreadAsTheyPromise) {
    expect_disk(poisson_disk_16, 0.440);
    expect_disk(poisson_disk_32, 0.298);
}

TEST(Pcf, HashIsEvenAndKnowsNoNeighbours) {
    double sum = 0, product = 0;
    constexpr int side = 256;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double h = pixel_hash(x, y);
            ASSERT_GE(h, 0);
            ASSERT_LT(h, 1);
            sum += h;
            product += (h - 0.5) * (pixel_hash(x + 1, y) - 0.5);
        }
    // Of 65536 independent values: standard errors 1 / sqrt(12 n) and 1 / (12 sqrt(n)); five of them.
    EXPECT_NEAR(sum / (side * side), 0.5, 5 / (std::sqrt(12.0) * side));
    EXPECT_NEAR(product / (side * side), 0, 5 / (12.0 * side));
}

}  // namespace
}  // namespace kiln::reference
