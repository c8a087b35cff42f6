// The hair references against integrals, a ray traced through a cylinder and the plain forms where those are in range.

#include "uber/reference/hair.h"

#include <gtest/gtest.h>

#include "uber/reference/fibre_trace.h"
#include "uber/reference/hair_cheap.h"
#include "uber/reference/hair_cheap_textbook.h"
#include "uber/reference/hair_textbook.h"

namespace kiln::reference {
namespace {

// Midpoint rule in theta with step pi/n. A lobe about theta = -+pi/2 starts with slope 1/v: the rule's error is
// step^2 / (24 v) there and far less elsewhere.
double longitudinal_integral(double v, double theta_o, int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double theta = pi * ((i + 0.5) / n - 0.5);
        sum += hair_longitudinal_textbook(sin(theta), cos(theta), sin(theta_o), cos(theta_o), v) * cos(theta);
    }
    return sum * pi / n;
}

TEST(Bessel, ScaledFormsMeetAtTheChangeOfMethod) {
    EXPECT_NEAR(bessel_i0_scaled_textbook(0.0), 1, 1e-15);
    EXPECT_NEAR(bessel_i0_scaled_textbook(1.0), 1.2660658777520084 * std::exp(-1.0), 1e-14);
    EXPECT_NEAR(bessel_k0_scaled_textbook(1.0), 0.42102443824070834 * std::exp(1.0), 1e-14);
    EXPECT_NEAR(bessel_i0_scaled_textbook(199.9999999) / bessel_i0_scaled_textbook(200.0000001), 1, 1e-8);
    EXPECT_NEAR(bessel_k0_scaled_textbook(199.9999999) / bessel_k0_scaled_textbook(200.0000001), 1, 1e-8);
}

TEST(Hair, LongitudinalLobeIntegratesToOneForEveryVariance) {
    for (const double v : {1e-4, 1e-3, 0.01, 0.0112, 0.1, 0.5, 1.0, 2.0})
        for (const double theta_o : {0.0, 0.4, -1.1, 1.5, pi / 2})
            EXPECT_NEAR(longitudinal_integral(v, theta_o, 20000), 1, 1e-9 + pi * pi / (4e8 * 20 * v)) << v << ' ' << theta_o;
}

TEST(Hair, LongitudinalLobeIsThePrintedOneWhereThatIsFinite) {
    for (const double v : {0.05, 0.2, 1.0, 3.0})
        for (const double ti : {-1.2, 0.1, 0.9})
            for (const double to : {-0.7, 0.0, 1.4}) {
                const double printed =
                    std::exp(-sin(ti) * sin(to) / v) * std::cyl_bessel_i(0.0, cos(ti) * cos(to) / v) / (2 * v * std::sinh(1 / v));
                EXPECT_NEAR(hair_longitudinal_textbook(sin(ti), cos(ti), sin(to), cos(to), v) / printed, 1, 1e-12);
            }
}

TEST(Hair, SinhOverflowsSinglePrecisionBelowRow34) {
    EXPECT_TRUE(std::isinf(std::sinh(1.0f / 0.01118f)));
    EXPECT_FALSE(std::isinf(std::sinh(1.0f / 0.01119f)));
}

TEST(Hair, AzimuthalLobeIntegratesToOne) {
    for (const double beta : {0.1, 0.3, 0.7, 1.0})
        for (int p = 0; p < 3; ++p) {
            const double s = hair_logistic_scale(beta);
            double sum = 0;
            const int n = 20000;
            for (int i = 0; i < n; ++i) sum += hair_azimuthal_textbook(2 * pi * (i + 0.5) / n, p, s, 0.5, 0.3);
            // The kink at +-pi and the peak are smooth on a scale s > 0.02: the midpoint rule is good to (step/s)^2.
            EXPECT_NEAR(sum * 2 * pi / n, 1, 1e-4) << beta << ' ' << p;
        }
}

TEST(Hair, AttenuationsWithoutAbsorptionSumToOne) {
    for (const double f : {0.0, 0.0465, 0.5, 0.999, 1.0}) {
        double sum = 0;
        for (int p = 0; p < 4; ++p) sum += hair_attenuation_textbook(p, f, splat3(1.0)).x;
        EXPECT_NEAR(sum, 1, 1e-14) << f;
    }
}

TEST(Hair, AttenuationAndAzimuthAreThoseOfARayThroughACylinder) {
    for (const double sin_theta : {0.0, 0.3, -0.8})
        for (const double h : {-0.95, -0.4, 0.0, 0.6, 0.99}) {
            const double eta = 1.55, absorption = 0.4;
            const auto paths = trace_fibre(sin_theta, -h, eta, absorption);  // its h is along z
            const double so = -sin_theta, co = std::sqrt(1 - so * so);
            const double gamma_o = std::asin(h), gamma_t = std::asin(h * co / std::sqrt(eta * eta - so * so));
            const double f = hair_fresnel(co * std::cos(gamma_o), eta);
            const double cos_theta_t = std::sqrt(1 - so * so / (eta * eta));
            const Vec3<double> t = hair_transmittance_textbook(splat3(absorption), std::cos(gamma_t), cos_theta_t);
            for (int p = 0; p < 3; ++p) {
                const FibrePath& path = paths[static_cast<std::size_t>(p)];
                EXPECT_NEAR(hair_attenuation_textbook(p, f, t).x, path.share, 1e-12) << h << ' ' << p;
                EXPECT_NEAR(path.direction.x, sin_theta, 1e-12);
                // to_eye has azimuth 0: the lobe's centre is where the ray leaves.
                const double centre = 2 * p * gamma_t - 2 * gamma_o + p * pi;
                const double phi = atan(path.direction.z, path.direction.y);
                EXPECT_NEAR(std::cos(centre - phi), 1, 1e-12) << h << ' ' << p;
            }
        }
}

// White furnace: no absorption, light from everywhere; all of it leaves, for any roughness, tilt and h.
double furnace(const HairFibre<double>& fibre, double theta_o, double h, int n_theta, int n_phi) {
    const Vec3<double> eye{sin(theta_o), cos(theta_o), 0};
    double sum = 0;
    for (int i = 0; i < n_theta; ++i) {
        const double theta = pi * ((i + 0.5) / n_theta - 0.5);
        for (int j = 0; j < n_phi; ++j) {
            const double phi = 2 * pi * (j + 0.5) / n_phi;
            const Vec3<double> light{sin(theta), cos(theta) * cos(phi), cos(theta) * sin(phi)};
            sum += hair_chiang(fibre, light, eye, h).x * cos(theta);
        }
    }
    return sum * pi / n_theta * 2 * pi / n_phi;
}

TEST(Hair, WhiteFurnaceOfChiangIsOne) {
    for (const double beta : {0.25, 0.6, 1.0})
        for (const double tilt : {0.0, 0.035})
            for (const double theta : {0.1, -0.9, 1.4})
                for (const double h : {-0.7, 0.2}) {
                    const HairFibre<double> fibre{splat3(0.0), 1.55, beta, beta, tilt};
                    EXPECT_NEAR(furnace(fibre, theta, h, 120, 120), 1, 1e-3) << beta << ' ' << tilt << ' ' << theta;
                }
}

TEST(Hair, AbsorptionDarkens) {
    HairFibre<double> fibre{Vec3<double>{0.1, 0.5, 2}, 1.55, 0.4, 0.4, 0.035};
    const Vec3<double> s = hair_chiang(fibre, Vec3<double>{0.1, -0.9, 0.42426406871192845}, Vec3<double>{0, 1, 0}, 0.1);
    EXPECT_GT(s.x, s.y);
    EXPECT_GT(s.y, s.z);
    EXPECT_NEAR(hair_absorption(splat3(1.0), 0.3).x, 0, 0);
}

// A direction that covers the sphere as i runs from 0 to 200.
Vec3<double> spread(int i) {
    const double z = 2 * (i + 0.5) / 200 - 1, q = std::sqrt(1 - z * z), a = 2 * pi * 0.61803398875 * i;
    return {z, q * cos(a), q * sin(a)};
}

TEST(Bessel, FitsAreAsGoodAsTheyAreSaidToBe) {
    for (double x = 1e-3; x < 1e5; x *= 1.13) {
        EXPECT_NEAR(bessel_i0_scaled(x) / bessel_i0_scaled_textbook(x), 1, 5e-7) << x;
        EXPECT_NEAR(bessel_k0_scaled(x) / bessel_k0_scaled_textbook(x), 1, 3e-7) << x;
    }
}

TEST(Hair, FormsAgreeWithTheTextbook) {
    EXPECT_NEAR(hair_fresnel(0.3, 1.55), hair_fresnel_textbook(0.3, 1.55), 1e-14);
    EXPECT_NEAR(hair_absorption(splat3(0.3), 0.4).x, hair_absorption_textbook(splat3(0.3), 0.4).x, 1e-14);
    for (const double beta : {0.05, 0.3, 1.0}) {
        EXPECT_NEAR(hair_variance(2, beta) / hair_variance_textbook(2, beta), 1, 1e-13);
        EXPECT_NEAR(hair_logistic_scale(beta) / hair_logistic_scale_textbook(beta), 1, 1e-13);
        for (int i = 0; i < 200; ++i) {
            const HairFibre<double> fibre{{0, 0.3, 2}, 1.55, beta, beta, 0.035};
            const Vec3<double> light = spread(i), eye = spread((i * 37 + 11) % 200);
            const double h = 2 * ((i * 7 % 200) + 0.5) / 200 - 1;
            const Vec3<double> a = hair_chiang(fibre, light, eye, h), b = hair_chiang_textbook(fibre, light, eye, h);
            // The Bessel fit's 5e-7, and in narrow lobes the angles' own rounding over v.
            EXPECT_NEAR(a.x, b.x, 1e-6 * b.x + 1e-12) << i;
            EXPECT_NEAR(a.z, b.z, 1e-6 * b.z + 1e-12) << i;
        }
    }
}

TEST(HairCheap, FormsAgreeWithTheTextbook) {
    const Vec3<double> t{1, 0, 0}, colour{0.9, 0.4, 0.01};
    for (int i = 0; i < 200; ++i) {
        const Vec3<double> light = spread(i), eye = spread((i * 37 + 11) % 200);
        const Vec3<double> a = hair_karis(t, light, eye, colour, 0.3, 0.5, 0.7);
        const Vec3<double> b = hair_karis_textbook(t, light, eye, colour, 0.3, 0.5, 0.7);
        EXPECT_NEAR(a.x, b.x, 1e-8 * b.x + 1e-14) << i;
        EXPECT_NEAR(a.z, b.z, 1e-8 * b.z + 1e-14) << i;
        EXPECT_NEAR(hair_kajiya_kay(t, light, eye, colour, colour, 40.0).y,
                    hair_kajiya_kay_textbook(t, light, eye, colour, colour, 40.0).y, 1e-12);
        EXPECT_NEAR(hair_scheuermann(t, light, eye, 40.0), hair_scheuermann_textbook(t, light, eye, 40.0), 1e-12);
    }
}

TEST(HairCheap, KajiyaKayPeaksOnTheMirroredCone) {
    const Vec3<double> tangent{1, 0, 0};
    const Vec3<double> light{0.6, 0.8, 0}, eye{-0.6, 0, 0.8};
    const Vec3<double> s = hair_kajiya_kay(tangent, light, eye, splat3(0.0), splat3(1.0), 100.0);
    EXPECT_NEAR(s.x, 1, 1e-12);
    EXPECT_NEAR(hair_kajiya_kay(tangent, light, -eye, splat3(0.5), splat3(0.0), 8.0).x, 0.4, 1e-15);
}

TEST(HairCheap, DiffuseOfKajiyaAndKayReflectsPiSquared) {
    // Over the sphere sin(t, l) integrates to 2 pi times the integral of sin^2 over [0, pi].
    double sum = 0;
    const int n = 1000;
    for (int i = 0; i < n; ++i) {
        const double theta = pi * (i + 0.5) / n;
        const Vec3<double> light{cos(theta), sin(theta), 0};
        sum += hair_kajiya_kay({1, 0, 0}, light, {0, 0, 1}, splat3(1.0), splat3(0.0), 1.0).x * sin(theta);
    }
    EXPECT_NEAR(sum * pi / n * 2 * pi, pi * pi, 1e-9);
}

TEST(HairCheap, KarisIsFiniteStraightBehindAndNeverNegative) {
    for (const double roughness : {0.0, 0.3, 1.0})
        for (int i = 0; i < 200; ++i) {
            const double a = 0.61803398875 * i, z = 2 * ((i + 0.5) / 200) - 1, q = std::sqrt(1 - z * z);
            const Vec3<double> light{z, q * cos(2 * pi * a), q * sin(2 * pi * a)};
            for (const Vec3<double>& eye : {Vec3<double>{0, 1, 0}, -light, light, Vec3<double>{1, 0, 0}}) {
                const Vec3<double> s = hair_karis({1, 0, 0}, light, eye, {0.8, 0.4, 0.0}, roughness, 0.5, 1.0);
                EXPECT_TRUE(std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z)) << i;
                EXPECT_GE(min(min(s.x, s.y), s.z), 0.0);
            }
        }
}

}  // namespace
}  // namespace kiln::reference
