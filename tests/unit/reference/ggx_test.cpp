// The library's GGX terms against closed forms, and in single precision.

#include "uber/reference/ggx.h"

#include <gtest/gtest.h>

#include <random>

#include "uber/reference/furnace.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;
using F3 = Vec3<float>;

const V3 up{0, 0, 1};

// GCC 12 at -O2 drops a rounding to float and back when it sees both (its vectoriser does).
[[gnu::noinline]] F3 narrow(const V3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }
V3 wide(const F3& v) { return {value(v.x), value(v.y), value(v.z)}; }

TEST(Ggx, DistributionIntegratesToOne) {
    const TanhSinh quadrature(110);
    for (const double alpha : {0.002025, 0.01, 0.1, 0.5, 1.0})
        EXPECT_NEAR(
            distribution_integral(alpha, quadrature, [&](const V3& n, const V3& h) { return ggx_distribution(n, h, alpha); }),
            1.0, 1e-11)
            << alpha;
}

TEST(Ggx, HasTheKnownValues) {
    EXPECT_NEAR(ggx_distribution(up, up, 0.25), 5.09295817894, 1e-11);
    EXPECT_NEAR(ggx_distribution(up, from_polar(0.95, 0), 0.25), 0.839880758209, 1e-11);
    EXPECT_NEAR(ggx_distribution(up, from_polar(std::sqrt(0.5), 0), 1e-2), 1.27298494e-4, 1e-12);
    EXPECT_NEAR(ggx_distribution(up, from_polar(0.95, 1), 0.25), ggx_distribution_textbook(0.95, 0.25), 1e-14);
    EXPECT_NEAR(ggx_visibility(0.1, 0.1, 0.25), 9.32504808, 1e-8);
    EXPECT_NEAR(ggx_visibility(0.3, 0.7, 0.25), ggx_visibility_textbook(0.3, 0.7, 0.25), 1e-14);
    EXPECT_NEAR(ggx_alpha(0.5), 0.25, 1e-15);
    EXPECT_NEAR(ggx_alpha(0.0), 0.045 * 0.045, 1e-15);
    EXPECT_EQ(ggx_alpha(3.0), 1.0);
}

TEST(Ggx, DistributionKeepsItsDigitsInSinglePrecision) {
    // The difference of two floats near one another is exact, so that every further operation rounds once: eleven of them,
    // those of the square k twice, are 2^-24 each.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const float alpha : {0.002025f, 0.01f, 0.1f, 0.5f})
        for (int i = 0; i < 20'000; ++i) {
            const V3 n = from_polar(unit(random) * 2 - 1, unit(random) * 2 * pi);
            const double angle = 3 * value(alpha) * unit(random);
            const V3 side = safe_normalize(cross(n, V3{unit(random) - 0.5, unit(random) - 0.5, unit(random) + 0.1}), up);
            const F3 n32 = narrow(n), h32 = narrow(n * std::cos(angle) + side * std::sin(angle));
            const double exact = ggx_distribution(wide(n32), wide(h32), value(alpha));
            ASSERT_NEAR(value(ggx_distribution(n32, h32, alpha)) / exact, 1.0, 22 * 0x1p-24) << alpha << " " << angle;
        }
}

}  // namespace
}  // namespace kiln::reference
