// Spherical-harmonics references against closed forms: the lobe's energy by band, delta lights, caps, linear skies.

#include "uber/reference/sh.h"

#include <gtest/gtest.h>

#include "uber/reference/sh_lightmap.h"
#include "uber/reference/skies.h"

namespace kiln::reference {
namespace {

using V = Vec3<double>;

const V up{0.0, 0.0, 1.0};
const V tilted = normalize(V{0.3, -0.5, 0.8});

V at(double cosine) { return {std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), 0.0, cosine}; }

// A light so small that only its irradiance on a receiver that faces it, 1, is known.
ShMomentsL1<double> delta_moments(const V& p) { return {splat3(1.0), splat3(p.y), splat3(p.z), splat3(p.x)}; }
ShL2<double> delta_l2(const V& p) { return sh_l2_accumulate(ShL2<double>{}, p, splat3(1.0), 1.0); }
ShL1<double> delta_l1(const V& p) { return sh_l1_accumulate(ShL1<double>{}, p, splat3(1.0), 1.0); }

TEST(Sh, BasisIsOrthonormal) {
    for (size_t i = 0; i < 9; ++i) {
        for (size_t j = 0; j <= i; ++j) {
            const double sum = sphere_integral(1, 16, [&](const V& p) {
                const std::array<double, 9> y = sh_l2_basis(p);
                return y[i] * y[j];
            });
            EXPECT_NEAR(sum, i == j ? 1.0 : 0.0, 1e-13) << i << " " << j;
        }
    }
    const std::array<double, 9> y = sh_l2_basis(V{1.0, 1.0, 1.0});
    EXPECT_NEAR(y[0], 0.282094791774, 1e-12);
    EXPECT_NEAR(y[1], 0.488602511903, 1e-12);
    EXPECT_NEAR(y[4], 1.092548430592, 1e-12);
    EXPECT_NEAR(y[6] / 2.0, 0.315391565253, 1e-12);
    EXPECT_NEAR(sh_l2_basis(V{1.0, 0.0, 0.0})[8], 0.546274215296, 1e-12);
}

// The clamped cosine's eigenvalues from their definition: 2 pi times the integral of c P_l(c) over [0, 1].
TEST(Sh, EigenvaluesAreTheCosineLobes) {
    EXPECT_NEAR(sh_cosine_eigenvalue(0), 2.0 * pi * 0.5, 1e-15);
    EXPECT_NEAR(sh_cosine_eigenvalue(1), 2.0 * pi / 3.0, 1e-15);
    EXPECT_NEAR(sh_cosine_eigenvalue(2), 2.0 * pi * (3.0 / 8.0 - 1.0 / 4.0), 1e-15);
    // Energy of a band: its eigenvalue squared times (2 l + 1) / (4 pi), over the lobe's 2 pi / 3.
    double energy = 0.0;
    const double cumulative[3] = {0.375, 0.875, 0.9921875};
    for (int l = 0; l < 3; ++l) {
        energy += sh_cosine_eigenvalue(l) * sh_cosine_eigenvalue(l) * (2 * l + 1) / (4.0 * pi) / (2.0 * pi / 3.0);
        EXPECT_NEAR(energy, cumulative[l], 1e-15);
    }
}

struct Errors {
    double worst = 0, rms = 0, least = 1e9;
};
// Over the sphere of normals, against max(0, c). Pieces end at c = -1/2 and 0, where the clamped forms have their kinks.
template <class E>
Errors against_delta(E irradiance) {
    Errors out;
    double square = 0;
    constexpr int steps = 40'000;  // by 1/2 of the sphere's 4 pi each, midpoint: error below 1e-9
    for (int i = 0; i <= steps; ++i) {
        const double c = -1.0 + 2.0 * i / steps;
        const double e = irradiance(c), error = e - std::max(0.0, c);
        out.worst = std::max(out.worst, std::fabs(error));
        out.least = std::min(out.least, e);
        square += error * error * (i == 0 || i == steps ? 0.5 : 1.0);
    }
    out.rms = std::sqrt(square / steps);
    return out;
}

TEST(Sh, DeltaLightHasTheKnownErrors) {
    const ShMomentsL1<double> m = delta_moments(up);
    const ShL2<double> l2 = delta_l2(up);
    const Errors ambient = against_delta([&](double) { return m.m0.x / 4.0; });
    EXPECT_NEAR(ambient.worst, 0.75, 1e-12);
    EXPECT_NEAR(ambient.rms, 0.322748612, 1e-8);
    const Errors l1 = against_delta([&](double c) { return sh_irradiance_from_moments(m, at(c)).x; });
    EXPECT_NEAR(l1.worst, 0.25, 1e-12);
    EXPECT_NEAR(l1.rms, 0.144337567, 1e-8);
    EXPECT_NEAR(l1.least, -0.25, 1e-12);
    const Errors clamped = against_delta([&](double c) { return sh_irradiance_clamped(m, at(c)).x; });
    EXPECT_NEAR(clamped.rms, 0.125, 1e-8);
    EXPECT_EQ(clamped.least, 0.0);
    const Errors second = against_delta([&](double c) { return sh_irradiance_from_radiance(l2, at(c)).x; });
    EXPECT_NEAR(second.worst, 0.09375, 1e-12);
    EXPECT_NEAR(second.rms, 0.036084392, 1e-8);
    EXPECT_NEAR(second.least, -0.0395833, 1e-7);
    const Errors second_clamped = against_delta([&](double c) { return sh_irradiance_clamped(l2, at(c)).x; });
    EXPECT_NEAR(second_clamped.rms, 0.032546115, 1e-8);
    // ((1 + c)/2)^3 - max(0, c) has the mean square 1/7 - 49/160 + 1/6.
    const Errors hazel = against_delta([&](double c) { return sh_irradiance_nonlinear(m, at(c)).x; });
    EXPECT_NEAR(hazel.rms, std::sqrt(1.0 / 7.0 - 49.0 / 160.0 + 1.0 / 6.0), 1e-8);
    EXPECT_NEAR(sh_irradiance_nonlinear(m, up).x, 1.0, 1e-12);
    EXPECT_GE(hazel.least, 0.0);
    // k = 1: 1/4 + c/2 + s (3 c^2 - 1), s = sqrt(5)/32 (0.08 sqrt(3) + 1.8); least at c = -1/(12 s), and 1.02 facing the light.
    const double s = std::sqrt(5.0) / 32.0 * (0.08 * std::sqrt(3.0) + 1.8);
    const Errors zh3 = against_delta([&](double c) { return sh_irradiance_zh3(m, at(c)).x; });
    EXPECT_NEAR(zh3.rms, 0.040592, 1e-5);
    EXPECT_NEAR(zh3.least, 0.25 - s - 1.0 / (48.0 * s), 1e-8);
    EXPECT_NEAR(sh_irradiance_zh3(m, up).x, 0.75 + 2.0 * s, 1e-12);
    const Errors shared = against_delta([&](double c) { return sh_irradiance_zh3_luminance(m, at(c)).y; });
    EXPECT_NEAR(shared.rms, zh3.rms, 1e-12);
}

// The guessed band is band 2 of the light's own axis: what three bands of a light with these c0, c1 and c2 have.
TEST(Sh, Zh3IsABandAboutTheAxis) {
    const ShL1<double> two{{splat3(0.7), splat3(0.3 * tilted.y), splat3(0.3 * tilted.z), splat3(0.3 * tilted.x)}};
    const double r = 0.3 / 0.7, c2 = 0.7 * (0.08 * r + 0.6 * r * r);
    const std::array<double, 9> y = sh_l2_basis(tilted);
    ShL2<double> three;
    for (size_t i = 0; i < 4; ++i) three.c[i] = two.c[i];
    // Coefficients of a zonal band about an axis are sqrt(4 pi / 5) times the basis there.
    for (size_t i = 4; i < 9; ++i) three.c[i] = splat3(c2 * std::sqrt(4.0 * pi / 5.0) * y[i]);
    for (const V& n : {up, tilted, normalize(V{-1, 2, 0.1}), V{1, 0, 0}})
        EXPECT_NEAR(sh_irradiance_zh3(sh_moments_of(two), n).x, sh_irradiance_from_radiance(three, n).x, 1e-14);
}

// A red lamp overhead and a blue one from the side: each has an axis of its own, and the luminance's is neither.
TEST(Sh, Zh3OfTwoColoursNeedsTwoAxes) {
    const V aside{1.0, 0.0, 0.0}, red{1.0, 0.0, 0.0}, blue{0.0, 0.0, 1.0};
    const ShMomentsL1<double> m =
        sh_moments_accumulate(sh_moments_accumulate(ShMomentsL1<double>{}, up, red, 1.0), aside, blue, 1.0);
    double own = 0, shared = 0;
    for (int i = 0; i < 4000; ++i) {
        const double c = -1.0 + 2.0 * (i + 0.5) / 4000, s = std::sqrt(1 - c * c), phi = 2.399963 * i;
        const V n{s * std::cos(phi), s * std::sin(phi), c}, truth = red * std::max(c, 0.0) + blue * std::max(n.x, 0.0);
        const V a = sh_irradiance_zh3(m, n) - truth, b = sh_irradiance_zh3_luminance(m, n) - truth;
        own += dot(a, a) / 4000, shared += dot(b, b) / 4000;
    }
    std::printf("zh3 of two colours: RMSE %.4f about own axes, %.4f about the luminance's\n", std::sqrt(own), std::sqrt(shared));
    EXPECT_NEAR(std::sqrt(own), std::sqrt(2.0) * 0.040592, 1e-3);
    EXPECT_GT(shared, 2 * own);
}

// All valid pairings of what the bake stores and what shading multiplies by, and the two that are not.
TEST(Sh, PairingsOfBakeAndShading) {
    for (const double c : {-1.0, -0.4, 0.0, 0.6, 1.0}) {
        const V n = at(c);
        const double right = 0.25 + 0.5 * c;
        const ShMomentsL1<double> m = delta_moments(up);
        EXPECT_NEAR(sh_irradiance_from_moments(m, n).x, right, 1e-14);
        EXPECT_NEAR(sh_irradiance_from_weighted(sh_l1_weight(m), n).x, right, 1e-14);
        EXPECT_NEAR(sh_irradiance_from_radiance(delta_l1(up), n).x, right, 1e-14);
        EXPECT_NEAR(sh_irradiance_convolved(sh_l1_convolve(delta_l1(up)), n).x, right, 1e-14);
        EXPECT_NEAR(sh_irradiance_from_moments(sh_moments_of(delta_l1(up)), n).x, right, 1e-14);
        const ShL1<double> l1 = delta_l1(up);
        const Vec4<double> coefficients{l1.c[0].x, l1.c[1].x, l1.c[2].x, l1.c[3].x};
        EXPECT_NEAR(sh_irradiance_lecture(coefficients, n), 0.070524 + 0.244301 * c, 1e-6);
    }
    // A furnace of radiance 1: pi for all, 0.886227 by the naive reading.
    const double c00 = 4.0 * pi * std::sqrt(1.0 / (4.0 * pi));
    EXPECT_NEAR(c00, 3.544907702, 1e-9);
    const ShMomentsL1<double> furnace = linear_sky_moments(1.0, 0.0, up);
    EXPECT_NEAR(sh_irradiance_from_radiance(ShL1<double>{{splat3(c00)}}, tilted).x, pi, 1e-12);
    EXPECT_NEAR(sh_irradiance_from_moments(furnace, tilted).x, pi, 1e-12);
    EXPECT_NEAR(sh_irradiance_nonlinear(furnace, tilted).x, pi, 1e-12);
    EXPECT_NEAR(sh_irradiance_lecture(Vec4<double>{c00, 0, 0, 0}, tilted), 0.886227, 1e-6);
}

// A furnace stays within 1e-6 in single precision, for every form and normal.
TEST(Sh, FurnaceInSinglePrecision) {
    using F = Vec3<float>;
    const float four_pi = static_cast<float>(4.0 * pi), c00 = 3.544907702f;
    const ShMomentsL1<float> m{splat3(four_pi), F{}, F{}, F{}};
    ShL2<float> l2{};
    l2.c[0] = splat3(c00);
    const ShL1<float> l1{{splat3(c00), F{}, F{}, F{}}};
    for (const F& n : {F{0, 0, 1}, F{0.6f, 0, 0.8f}, F{0, -1, 0}}) {
        for (const float e :
             {sh_irradiance_from_moments(m, n).x, sh_irradiance_nonlinear(m, n).x, sh_irradiance_from_radiance(l1, n).x,
              sh_irradiance_from_radiance(l2, n).x, sh_irradiance_clamped(l2, n).x}) {
            EXPECT_NEAR(static_cast<double>(e) / pi, 1.0, 1e-6);
        }
    }
}

// Filtering m0 and the ratio m1 / m0 apart is not filtering m1: halfway between (m0 1, ratio 1) and (m0 0.01, ratio -1), m1 is
// 0.495 and m0 times the ratio is 0. A lightmap's charts must not put such texels side by side.
TEST(Sh, RatiosAreNotLinear) {
    const double true_m1 = (1.0 * 1.0 + 0.01 * -1.0) / 2, decoded = (1.0 + 0.01) / 2 * ((1.0 - 1.0) / 2);
    EXPECT_NEAR(true_m1, 0.495, 1e-15);
    EXPECT_EQ(decoded, 0.0);
    const ShMomentsL1<double> mid{splat3(0.505), splat3(0.0), splat3(true_m1), splat3(0.0)};
    const V lightmap = sh_l1_irradiance(splat3(0.505), splat3(0.0), splat3(0.0), splat3(0.0), up);
    EXPECT_NEAR(sh_irradiance_from_moments(mid, up).x - lightmap.x, 0.495 / 2, 1e-15);
}

// Also for moments that no light has: negative m0, m1 longer than m0, nothing at all.
TEST(Sh, NonNegativeFormsStayThere) {
    for (const double m0 : {-2.0, 0.0, 1e-30, 1.0, 1e6}) {
        for (const double m1 : {0.0, 1e-20, 0.3, 1.0, 50.0}) {
            const ShMomentsL1<double> m{splat3(m0), splat3(0.6 * m1), splat3(-0.8 * m1), splat3(0.0)};
            for (const double c : {-1.0, -0.6, 0.0, 0.8, 1.0}) {
                const double clamped = sh_irradiance_clamped(m, at(c)).x, nonlinear = sh_irradiance_nonlinear(m, at(c)).x;
                EXPECT_GE(clamped, 0.0);
                EXPECT_GE(nonlinear, 0.0);
                EXPECT_LE(nonlinear, std::max(m0, 0.0) * (1.0 + 1e-12)) << "k is held at 1, where E is at most m0";
            }
        }
    }
}

TEST(Sh, QuadraticFormIsTheSum) {
    ShL2<double> sh;
    std::array<double, 9> channel{};
    for (size_t i = 0; i < 9; ++i) sh.c[i] = splat3(channel[i] = std::sin(3.7 * static_cast<double>(i) + 1.0));
    const Mat4<double> m = sh_quadratic_matrix(channel);
    for (const V& n : {up, tilted, normalize(V{-1, 2, 0.1}), V{1, 0, 0}, V{0, -1, 0}})
        EXPECT_NEAR(sh_quadratic_irradiance(m, n), sh_irradiance_from_radiance(sh, n).x, 1e-14);
    std::array<double, 9> one{};
    one[8] = 1.0;
    EXPECT_NEAR(sh_quadratic_matrix(one).columns[0].x, 0.429043, 5e-7);
    one = {1.0, 0, 0, 1.0, 0, 0, 1.0, 0, 0};
    const Mat4<double> c = sh_quadratic_matrix(one);
    EXPECT_NEAR(c.columns[0].w, 0.511663, 5e-7);
    EXPECT_NEAR(c.columns[2].z, 0.743124, 5e-7);
    EXPECT_NEAR(c.columns[3].w, 0.886227 - 0.247708, 1e-6);
}

TEST(Skies, CapIrradianceIsItsIntegral) {
    EXPECT_NEAR(cap_irradiance(1.0, pi / 6), pi * 0.25, 1e-14);
    EXPECT_NEAR(cap_irradiance(0.0, pi / 6), 0.090586074, 1e-9);
    for (const double c : {-1.0, -0.5, 0.0, 0.7, 1.0}) EXPECT_NEAR(cap_irradiance(c, pi / 2), pi * (1.0 + c) / 2.0, 1e-12);
    // The cap over its own axis: Gauss-Legendre in height, the horizon cut by many azimuths.
    for (const double s : {0.2, 0.8, 1.3}) {
        for (const double angle : {0.3, 1.2, 1.6, 2.2}) {
            const V n{std::sin(angle), 0.0, std::cos(angle)};
            double sum = 0;
            constexpr int heights = 400, turns = 4'000;
            for (int i = 0; i < heights; ++i) {
                const double z = std::cos(s) + (1.0 - std::cos(s)) * (i + 0.5) / heights, r = std::sqrt(1.0 - z * z);
                for (int j = 0; j < turns / 2; ++j) {
                    const double phi = 2.0 * pi * (j + 0.5) / turns;
                    sum += 2.0 * std::max(0.0, n.x * r * std::cos(phi) + n.z * z);
                }
            }
            EXPECT_NEAR(cap_irradiance(std::cos(angle), s), sum * (1.0 - std::cos(s)) / heights * 2.0 * pi / turns, 2e-5)
                << s << " " << angle;
        }
    }
}

// On the axis L1 gives the known share of a cap's irradiance; it is exact for half a sphere and for a linear sky.
TEST(Skies, L1OfCapsAndLinearSkies) {
    const struct {
        double degrees, ratio;
    } table[] = {{0.25, 0.750001}, {5, 0.750477}, {15, 0.754333}, {30, 0.767949}, {45, 0.792893}, {60, 0.833333}, {90, 1.0}};
    for (const auto& row : table) {
        const double s = row.degrees * pi / 180.0;
        const ShL2<double> sh = cap_sh(tilted, s);
        const ShL1<double> l1{{sh.c[0], sh.c[1], sh.c[2], sh.c[3]}};
        EXPECT_NEAR(sh_irradiance_from_radiance(l1, tilted).x / (pi * std::sin(s) * std::sin(s)), row.ratio, 6e-7);
        const ShMomentsL1<double> m = sh_moments_of(l1);
        EXPECT_NEAR(length(V{m.m1_x.x, m.m1_y.x, m.m1_z.x}) / m.m0.x, (1.0 + std::cos(s)) / 2.0,
                    1e-10);  // 1 - cos s of the smallest cancels five digits
        EXPECT_EQ(sh_irradiance_from_moments(m, -tilted).x >= -1e-12, row.degrees >= 90);
    }
    for (const double c : {-1.0, -0.3, 0.4, 1.0}) {
        EXPECT_NEAR(sh_irradiance_from_moments(linear_sky_moments(2.0, 1.5, up), at(c)).x, linear_sky_irradiance(2.0, 1.5, c),
                    1e-13);
        const V sum = sphere_integral(2, 64, [&](const V& p) {
            return V{(2.0 + 1.5 * p.z) * p.z, 2.0 + 1.5 * p.z, (2.0 + 1.5 * p.z) * p.x};
        });
        const ShMomentsL1<double> m = linear_sky_moments(2.0, 1.5, up);
        EXPECT_NEAR(sum.x, m.m1_z.x, 1e-12);
        EXPECT_NEAR(sum.y, m.m0.x, 1e-12);
        EXPECT_NEAR(sum.z, 0.0, 1e-12);
    }
}

}  // namespace
}  // namespace kiln::reference
