// FLIP by what its papers promise: their constants, the largest colour distance, edges, exposures.
#include "compiler/report/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiln::report {
namespace {

Picture flat(double r, double g, double b, uint32_t size = 24) {
    Picture p(size, size);
    for (size_t i = 0; i < p.pixels(); ++i) {
        p.rgb[3 * i] = r;
        p.rgb[3 * i + 1] = g;
        p.rgb[3 * i + 2] = b;
    }
    return p;
}

// Values of columns from `x` on are `after`, before it `before`.
Picture edge(uint32_t x, double before, double after, bool along_y = false, uint32_t size = 48) {
    Picture p(size, size);
    for (uint32_t j = 0; j < size; ++j)
        for (uint32_t i = 0; i < size; ++i)
            for (size_t c = 0; c < 3; ++c) p.rgb[3 * (size_t{j} * size + i) + c] = (along_y ? j : i) < x ? before : after;
    return p;
}

double largest(const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); }

TEST(Flip, PixelsADegreeOfThePaper) { EXPECT_NEAR(flip_pixels_per_degree, 67.02064327658225, 1e-10); }

TEST(Flip, EqualPicturesAreEqual) {
    for (const double v : ldr_flip(edge(20, 0.1, 0.9), edge(20, 0.1, 0.9))) EXPECT_EQ(v, 0.0);
    for (const double v : hdr_flip(edge(20, 0.1, 90.0), edge(20, 0.1, 90.0))) EXPECT_EQ(v, 0.0);
}

// Flat pictures have no features, so FLIP is the colour term alone: black to white is a HyAB distance of 100. The largest
// distance in the paper's range is green to blue.
TEST(Flip, BlackAgainstWhite) {
    const auto lab = [](double x, double y, double z) {
        const auto f = [](double t) { return std::cbrt(t); };
        const double l = 116.0 * f(y) - 16.0;
        return std::array<double, 3>{l, 0.01 * l * 500.0 * (f(x) - f(y)), 0.01 * l * 200.0 * (f(y) - f(z))};
    };
    // XYZ of linear sRGB's green and blue primaries over those of its white, D65.
    const auto green = lab(0.357576 / 0.950456, 0.715152, 0.119192 / 1.089058);
    const auto blue = lab(0.180437 / 0.950456, 0.072175, 0.950304 / 1.089058);
    const double hyab = std::fabs(green[0] - blue[0]) + std::hypot(green[1] - blue[1], green[2] - blue[2]);
    const double most = std::pow(hyab, 0.7), it = std::pow(100.0, 0.7);
    ASSERT_GT(it, 0.4 * most);
    const double expected = 0.95 + (it - 0.4 * most) / (0.6 * most) * 0.05;
    for (const double v : ldr_flip(flat(0, 0, 0), flat(1, 1, 1))) EXPECT_NEAR(v, expected, 1e-4);
    for (const double v : ldr_flip(flat(0, 1, 0), flat(0, 0, 1))) EXPECT_NEAR(v, 1.0, 1e-9);
}

TEST(Flip, StaysInItsRangeAndGrowsWithTheDifference) {
    double before = 0.0;
    for (const double grey : {0.21, 0.25, 0.35, 0.6, 1.0}) {
        const std::vector<double> v = ldr_flip(flat(0.2, 0.2, 0.2), flat(grey, grey, grey));
        EXPECT_GT(v[0], before);
        EXPECT_LE(largest(v), 1.0);
        before = v[0];
    }
}

TEST(Flip, SymmetricInItsArguments) {
    const Picture a = edge(20, 0.1, 0.8), b = edge(24, 0.3, 0.5);
    const std::vector<double> ab = ldr_flip(a, b), ba = ldr_flip(b, a);
    for (size_t i = 0; i < ab.size(); ++i) EXPECT_DOUBLE_EQ(ab[i], ba[i]);
}

// Sums come in another order along y, so filtered values differ by some 1e-15, and a feature is a root of one of them: 1e-7.
TEST(Flip, TurnsWithThePicture) {
    const std::vector<double> x = ldr_flip(edge(20, 0.1, 0.8), edge(24, 0.1, 0.8)),
                              y = ldr_flip(edge(20, 0.1, 0.8, true), edge(24, 0.1, 0.8, true));
    for (size_t j = 0; j < 48; ++j)
        for (size_t i = 0; i < 48; ++i) EXPECT_NEAR(x[j * 48 + i], y[i * 48 + j], 1e-7);
}

// A moved edge is seen where it was and where it is, not far away from it.
TEST(Flip, AMovedEdgeIsLocal) {
    const std::vector<double> v = ldr_flip(edge(20, 0.1, 0.8), edge(24, 0.1, 0.8));
    EXPECT_GT(v[24 * 48 + 22], 0.4);
    EXPECT_LT(v[24 * 48 + 46], 1e-3);
}

TEST(Flip, FeaturesAmplifyColour) {
    // The same mean difference, once as a flat shift and once as a thin line: the line is a feature.
    Picture line = flat(0.5, 0.5, 0.5, 48);
    for (size_t j = 0; j < 48; ++j)
        for (size_t c = 0; c < 3; ++c) line.rgb[3 * (j * 48 + 24) + c] = 0.9;
    const std::vector<double> v = ldr_flip(flat(0.5, 0.5, 0.5, 48), line);
    EXPECT_GT(v[24 * 48 + 24], v[24 * 48 + 34]);
    EXPECT_GT(v[24 * 48 + 24], 0.2);
}

// The tone curve gives 0.85 at x = y / 0.6 with y the root of (2.51 - 0.85 2.43) y^2 + (0.03 - 0.85 0.59) y = 0.85 0.14.
TEST(Flip, ExposuresOfThePaper) {
    Picture p(3, 1);
    for (size_t c = 0; c < 3; ++c) {
        p.rgb[c] = 0.25;
        p.rgb[3 + c] = 1.0;
        p.rgb[6 + c] = 16.0;
    }
    const Exposures e = flip_exposures(p);
    const double x = std::exp2(e.stop), y = 0.6 * x;  // the median is 1
    EXPECT_NEAR(y * (2.51 * y + 0.03) / (y * (2.43 * y + 0.59) + 0.14), 0.85, 1e-9);
    EXPECT_NEAR(e.stop - e.start, 4.0, 1e-9);
    EXPECT_EQ(e.count, 4u);
    EXPECT_EQ(flip_exposures(flat(1, 1, 1)).count, 2u);
}

TEST(Flip, HdrSeesWhatOneExposureHides) {
    // Bright parts differ by a factor 2 far above white; LDR clamps both to white.
    const Picture a = edge(20, 0.2, 50.0), b = edge(20, 0.2, 100.0);
    EXPECT_EQ(ldr_flip(a, b)[24 * 48 + 46], 0.0);
    EXPECT_GT(hdr_flip(a, b)[24 * 48 + 46], 0.05);
    EXPECT_LE(largest(hdr_flip(a, b)), 1.0);
}

TEST(Flip, NotFiniteIsAsWrongAsCanBe) {
    Picture x = flat(1, 1, 1);
    x.rgb[10] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(hdr_flip(flat(1, 1, 1), x)[3], 1.0);
}

}  // namespace
}  // namespace kiln::report
