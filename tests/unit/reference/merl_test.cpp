// MERL tables: where directions lie, what a table of GGX gives back, and which files are refused.

#include "uber/reference/merl.h"

#include <gtest/gtest.h>

#include "uber/reference/furnace.h"
#include "uber/reference/ggx_forms.h"
#include "uber/reference/merl_file.h"
#include "uber/reference/random.h"
#include "uber/reference/smith.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;
const V3 up{0, 0, 1};

// Rusinkiewicz's rotations, with acos, as the database's own reader has them.
V3 by_rotation(const V3& l, const V3& v) {
    const V3 h = normalize(l + v);
    const double phi_h = std::atan2(h.y, h.x), theta_h = std::acos(h.z);
    const auto about_z = [](const V3& p, double a) {
        return V3{p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
    };
    const auto about_y = [](const V3& p, double a) {
        return V3{p.x * std::cos(a) + p.z * std::sin(a), p.y, p.z * std::cos(a) - p.x * std::sin(a)};
    };
    const V3 d = about_y(about_z(l, -phi_h), -theta_h);
    double phi_d = std::atan2(d.y, d.x);
    if (phi_d < 0) phi_d += pi;
    return {90 * std::sqrt(theta_h / (0.5 * pi)), 90 * std::acos(std::fmin(d.z, 1.0)) / (0.5 * pi), 180 * phi_d / pi};
}

TEST(Merl, CoordinatesAreThoseOfTheRotations) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const V3 l = from_polar(0.01 + 0.98 * random(), 6.28 * random()), v = from_polar(0.01 + 0.98 * random(), 6.28 * random());
        const V3 c = merl_coordinates(up, l, normalize(l + v)), r = by_rotation(l, v);
        EXPECT_NEAR(c.x, r.x, 1e-6);
        EXPECT_NEAR(c.y, r.y, 1e-5);
        EXPECT_NEAR(std::remainder(c.z - r.z, 180.0), 0.0, 1e-6 / (c.x * c.y + 1e-9));
        // Reciprocity: light and view changed over lie in the same place.
        const V3 swapped = merl_coordinates(up, v, normalize(l + v));
        EXPECT_NEAR(std::remainder(swapped.z - c.z, 180.0), 0.0, 1e-6);
        // And back.
        const MerlDirections d = merl_directions(c);
        EXPECT_NEAR(dot(d.l, d.v), dot(l, v), 1e-9);
        EXPECT_NEAR(std::fmin(std::fabs(d.l.z - l.z), std::fabs(d.l.z - v.z)), 0.0, 1e-9);
    }
}

TEST(Merl, FirstBinsAndEnds) {
    const double edges[] = {0.0111, 0.0444, 0.1, 0.1778};  // degrees, of theta_h
    for (int i = 0; i < 4; ++i) {
        const double a = edges[i] * pi / 180;
        const auto bin = [&](double angle) {
            const V3 h{std::sin(angle), 0, std::cos(angle)};
            return merl_bin(merl_coordinates(up, h, h))[0];
        };
        EXPECT_EQ(bin(a * 0.99), i);
        EXPECT_EQ(bin(a * 1.01), i + 1);
    }
    EXPECT_EQ(merl_index(merl_bin({90, 90, 179.99})), merl_plane - 1);
    EXPECT_EQ(merl_index(merl_bin({0, 0, 0})), 0);
    EXPECT_EQ(merl_coordinates(up, up, up).z, 0.0);
    const MerlCorners first = merl_corners({0.2, 0.2, 0.2}), last = merl_corners({89.9, 89.9, 179.9});
    EXPECT_EQ(first.low, (std::array<int, 3>{0, 0, 179}));
    EXPECT_EQ(first.high, (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(last.low, (std::array<int, 3>{89, 89, 179}));
    EXPECT_EQ(last.high, (std::array<int, 3>{89, 89, 0}));
}

double ggx(const V3& l, const V3& v, const V3& h, double alpha) {
    return ggx_distribution_cross(up, h, alpha) * visibility_separable(l.z, v.z, alpha) *
           (0.04 + 0.96 * std::pow(1 - dot(l, h), 5));
}

// A table of GGX against GGX: the error is that of resampling, largest where D changes most from bin to bin.
TEST(Merl, TableOfGgxGivesGgxBack) {
    for (const double roughness : {0.1, 0.3, 0.7}) {
        const double alpha = roughness * roughness;
        std::vector<double> table(merl_plane);
        for (int i = 0; i < merl_plane; ++i) {
            const MerlDirections d = merl_directions({i / (90 * 180) + 0.5, i / 180 % 90 + 0.5, i % 180 + 0.5});
            table[static_cast<size_t>(i)] = d.l.z > 0 && d.v.z > 0 ? ggx(d.l, d.v, d.h, alpha) : 0;
        }
        const auto fetch = [&](int i) { return table[static_cast<size_t>(i)]; };
        Random random(7);
        double nearest2 = 0, between2 = 0, nearest_worst = 0, between_worst = 0;
        const int samples = 20000;
        for (int i = 0; i < samples; ++i) {
            // Up to theta_h 60 and theta_d 25 degrees no neighbour of the bin is below the horizon.
            const V3 c{0.5 + 72 * random(), 0.5 + 24 * random(), 180 * random()};
            const MerlDirections d = merl_directions(c);
            const double exact = ggx(d.l, d.v, d.h, alpha);
            const double nearest = fetch(merl_index(merl_bin(c))) / exact - 1, between = merl_interpolated(c, fetch) / exact - 1;
            nearest2 += nearest * nearest, between2 += between * between;
            nearest_worst = std::fmax(nearest_worst, std::fabs(nearest)),
            between_worst = std::fmax(between_worst, std::fabs(between));
        }
        // For small angles D falls with t = theta_h / alpha as (1 + t^2)^-2, and theta_h rises as the coordinate's square, so
        // |d ln D / d coordinate| = 8 t^1.5 / (1 + t^2) / x at most, x the coordinate of theta_h = alpha; its maximum, at
        // t^2 = 3, is 2 3^0.75 / x. Half a bin of that is the nearest bin's error, its square over 8 that of the chord.
        const double slope = 2 * std::pow(3.0, 0.75) / (90 * std::sqrt(alpha / (0.5 * pi)));
        EXPECT_LT(nearest_worst, 1.05 * std::expm1(0.5 * slope)) << roughness;
        EXPECT_LT(between_worst, 1.1 * slope * slope / 8) << roughness;
        EXPECT_LT(between2, 0.05 * nearest2) << roughness;
        // At a centre the table is exact, read either way.
        const V3 centre{20.5, 10.5, 33.5};
        const MerlDirections d = merl_directions(centre);
        EXPECT_NEAR(merl_interpolated(centre, fetch) / ggx(d.l, d.v, d.h, alpha), 1.0, 1e-9);
    }
}

std::vector<unsigned char> file_of(const std::vector<uint32_t>& bins, size_t doubles, double every) {
    std::vector<unsigned char> bytes;
    for (const uint32_t b : bins)
        for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<unsigned char>(b >> 8 * i));
    unsigned char image[8];
    std::memcpy(image, &every, 8);
    for (size_t i = 0; i < doubles; ++i) bytes.insert(bytes.end(), image, image + 8);
    return bytes;
}

TEST(MerlFile, IsReadAndUnmeasuredValuesAreNamed) {
    std::vector<unsigned char> bytes = file_of({90, 90, 180}, 3 * size_t{merl_plane}, 1500.0);
    const auto put = [&](size_t index, double x) { std::memcpy(&bytes[12 + 8 * index], &x, 8); };
    const MerlFile clean = parse_merl("gold.binary", bytes);
    EXPECT_EQ(clean.error, "");
    EXPECT_EQ(clean.warning, "");
    ASSERT_EQ(clean.values.size(), 3 * size_t{merl_plane});
    EXPECT_EQ(merl_reflectance(V3{clean.values[0], clean.values[merl_plane], -1.0}).y, 1.15);
    EXPECT_EQ(merl_reflectance(V3{clean.values[0], clean.values[merl_plane], -1.0}).z, 0.0);
    put(5, -1.0);
    put(6, std::numeric_limits<double>::quiet_NaN());
    put(7, std::numeric_limits<double>::infinity());
    put(9, 1e300);  // which no float holds
    put(8, 3.5);
    const MerlFile mended = parse_merl("gold.binary", bytes);
    EXPECT_EQ(mended.error, "");
    EXPECT_EQ(mended.warning, "gold.binary: 4 of 4374000 values are negative, above 1e38 or not numbers and count as 0");
    EXPECT_EQ(mended.values[5] + mended.values[6] + mended.values[7] + mended.values[9], 0.0);
    EXPECT_EQ(mended.values[8], 3.5);
    bytes.pop_back();
    EXPECT_EQ(parse_merl("gold.binary", bytes).error, "gold.binary: 34992011 bytes; a MERL file has 34992012");
}

TEST(MerlFile, RefusesWhatIsNone) {
    EXPECT_EQ(parse_merl("a", {}).error, "a: 0 bytes; a MERL file has 34992012");
    EXPECT_NE(parse_merl("a", file_of({90, 90, 360}, 100, 0)).error, "");
    EXPECT_EQ(parse_merl("a", file_of({90, 180, 90}, 3 * size_t{merl_plane}, 0)).error,
              "a: 90 x 180 x 90 bins; a MERL file has 90 x 90 x 180");
    EXPECT_EQ(load_merl("no/such.binary").error, "no/such.binary: cannot be read");
    EXPECT_TRUE(load_merl("no/such.binary").values.empty());
}

}  // namespace
}  // namespace kiln::reference
