// Tone curves: where they begin and end, that they rise, and that exposure follows the meter.

#include "uber/reference/tonemap.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

TEST(Tonemap, MeteredPictureComesOutWhereTheMeterSays) {
    // A mean of 2^ev / 8 has that exposure value; what saturates the sensor becomes 1.
    for (double ev = -10; ev <= 20; ev += 0.5)
        EXPECT_NEAR(exposure_from_mean(std::exp2(ev) / 8) / exposure_from_ev100(ev), 1, 1e-12) << ev;
    EXPECT_NEAR(exposure_from_ev100(15.0) * 1.2 * 32768, 1, 1e-12);
    EXPECT_NEAR(exposure_from_mean(9.6) * 9.6, 1.0 / 9.6, 1e-12);
}

TEST(Tonemap, CurvesBeginAtZeroRiseAndStayBelowOne) {
    const double white = 4;
    double last[3] = {-1, -1, -1};
    for (double x = 0; x < 1e5; x = x * 1.02 + 1e-4) {
        const double now[3] = {tone_reinhard(x), tone_reinhard_white(splat3(x), white).x, tone_aces(x)};
        for (int i = 0; i < 3; ++i) {
            EXPECT_GE(now[i], last[i]) << i << " at " << x;
            EXPECT_LE(now[i], 1) << i << " at " << x;
            last[i] = now[i];
        }
    }
    EXPECT_EQ(tone_reinhard(0.0), 0);
    EXPECT_EQ(tone_aces(0.0), 0);
    EXPECT_EQ(tone_reinhard(-1.0), 0);
    EXPECT_NEAR(tone_reinhard(1.0), 0.5, 1e-15);
    // 0.08 x^2 - 0.56 x - 0.14 = 0
    EXPECT_NEAR(tone_aces((0.56 + std::sqrt(0.56 * 0.56 + 4 * 0.08 * 0.14)) / 0.16), 1, 1e-12);
}

TEST(Tonemap, WhiteBecomesOneAndHuesStay) {
    for (const double white : {1.0, 2.0, 11.2, 1e3}) {
        EXPECT_NEAR(tone_reinhard_white(splat3(white), white).x, 1, 1e-12);
        const Vec3<double> dim{0.02, 0.01, 0.005}, shown = tone_reinhard_white(dim, white);
        EXPECT_NEAR(shown.x / shown.y, 2, 1e-12);
        EXPECT_NEAR(shown.y / shown.z, 2, 1e-12);
    }
}

}  // namespace
}  // namespace kiln::reference
