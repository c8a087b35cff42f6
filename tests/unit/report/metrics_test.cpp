// Every metric against values worked by hand.
#include "compiler/report/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kiln::report {
namespace {

Picture grey(const std::vector<double>& values) {
    Picture p(static_cast<uint32_t>(values.size()), 1);
    for (size_t i = 0; i < values.size(); ++i)
        for (size_t c = 0; c < 3; ++c) p.rgb[3 * i + c] = values[i];
    return p;
}

TEST(Metrics, EqualPicturesHaveNoError) {
    const Picture r = grey({0.0, 1.0, 5.0});
    const Metrics m = measure(r, r);
    EXPECT_EQ(m.relmse, 0.0);
    EXPECT_EQ(m.rmse, 0.0);
    EXPECT_EQ(m.max_rel, 0.0);
    EXPECT_EQ(m.max_abs, 0.0);
    EXPECT_EQ(m.bias, 0.0);
    EXPECT_EQ(m.nonfinite, 0u);
}

TEST(Metrics, WorkedByHand) {
    // r = 1, 3: mean 2, so 0.01 mean^2 = 0.04. x - r = 0.5, -1.
    const Metrics m = measure(grey({1.5, 2.0}), grey({1.0, 3.0}));
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt((0.25 + 1.0) / 2.0));
    EXPECT_DOUBLE_EQ(m.relmse, (0.25 / 1.04 + 1.0 / 9.04) / 2.0);
    EXPECT_DOUBLE_EQ(m.max_rel, 0.5);
    EXPECT_DOUBLE_EQ(m.max_abs, 1.0);
    EXPECT_DOUBLE_EQ(m.bias, -0.5 / 4.0);
}

TEST(Metrics, MaxRelDividesByAThousandthOfTheLargest) {
    const Metrics m = measure(grey({0.001, 10.0}), grey({0.0, 10.0}));
    EXPECT_DOUBLE_EQ(m.max_rel, 0.001 / 0.01);
}

TEST(Metrics, NumbersThatAreNotFiniteAreCountedAndLeftOut) {
    Picture x = grey({1.0, 2.0, 3.0});
    x.rgb[0] = std::numeric_limits<double>::quiet_NaN();
    x.rgb[4] = std::numeric_limits<double>::infinity();
    const Metrics m = measure(x, grey({1.0, 2.0, 4.0}));
    EXPECT_EQ(m.nonfinite, 2u);
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt(3.0 / 7.0));
    EXPECT_DOUBLE_EQ(m.max_abs, 1.0);
}

TEST(Metrics, BlackReference) {
    EXPECT_EQ(measure(grey({0.0}), grey({0.0})).relmse, 0.0);
    EXPECT_TRUE(std::isinf(measure(grey({0.1}), grey({0.0})).relmse));
    EXPECT_TRUE(std::isinf(measure(grey({-0.1}), grey({0.0})).bias));
}

TEST(Metrics, RegionCountsItsPixelsAlone) {
    const Metrics m = measure(grey({2.0, 9.0, 3.0}), grey({1.0, 1.0, 3.0}), {true, false, true});
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt(0.5));
    EXPECT_DOUBLE_EQ(m.bias, 0.25);
    EXPECT_EQ(measure(grey({2.0}), grey({1.0}), {false}).rmse, 0.0);
}

// A reference off by its standard deviation everywhere, either way, changes no metric by more than is said.
TEST(Noise, CoversWhatAnUncertainReferenceDoes) {
    Picture r(4, 1), x(4, 1);
    std::vector<double> variance(12);
    for (size_t i = 0; i < 12; ++i) {
        r.rgb[i] = 1.0 + 0.1 * static_cast<double>(i);
        x.rgb[i] = r.rgb[i] * (i % 2 == 0 ? 1.2 : 0.95);
        variance[i] = 1e-4 * static_cast<double>(1 + i % 3);
    }
    const Metrics measured = measure(x, r), noise = noise_of(measured, r, variance);
    EXPECT_GT(noise.rmse, 0.0);
    EXPECT_LT(noise.rmse, 0.02);
    for (const int way : {-1, 0, 1}) {
        Picture off = r;
        for (size_t i = 0; i < 12; ++i)
            off.rgb[i] += (way == 0 ? (x.rgb[i] > r.rgb[i] ? -1.0 : 1.0) : way) * std::sqrt(variance[i]);
        const Metrics m = measure(x, off);
        EXPECT_LE(std::fabs(m.rmse - measured.rmse), noise.rmse + 1e-12);
        EXPECT_LE(std::fabs(m.relmse - measured.relmse), 1.1 * noise.relmse);
        EXPECT_LE(std::fabs(m.bias - measured.bias), 1.2 * noise.bias);
        EXPECT_LE(std::fabs(m.max_rel - measured.max_rel), noise.max_rel);
        EXPECT_LE(std::fabs(m.max_abs - measured.max_abs), noise.max_abs);
    }
    EXPECT_EQ(noise_of(measured, r, {}).rmse, 0.0);
}

// Many pictures of the same noise: their metrics scatter as one picture's own estimate says, within a factor 1.5.
TEST(Noise, OfAMemberIsKnownFromOnePicture) {
    uint32_t state = 1;
    const auto uniform = [&] { return static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24; };
    Picture r(16, 16);
    for (double& v : r.rgb) v = 1.0;
    double sum[3] = {}, squares[3] = {}, said[3] = {};
    const int pictures = 300;
    for (int k = 0; k < pictures; ++k) {
        Picture x(16, 16);
        for (size_t i = 0; i < x.pixels(); ++i) {
            const double d = uniform() - 0.4;
            for (size_t c = 0; c < 3; ++c) x.rgb[3 * i + c] = 1.0 + d;
        }
        const Metrics m = measure(x, r), noise = sampling_noise_of(m, x, r);
        const double values[3] = {m.rmse, m.relmse, m.bias}, noises[3] = {noise.rmse, noise.relmse, noise.bias};
        for (int i = 0; i < 3; ++i) {
            sum[i] += values[i] / pictures;
            squares[i] += values[i] * values[i] / pictures;
            said[i] += noises[i] / pictures;
        }
    }
    for (int i = 0; i < 3; ++i) {
        const double seen = 2.0 * std::sqrt(squares[i] - sum[i] * sum[i]);
        EXPECT_LT(said[i], 1.5 * seen) << i;
        EXPECT_GT(said[i], seen / 1.5) << i;
    }
}

}  // namespace
}  // namespace kiln::report
