// Exact and fitted Fresnel reflectances against complex arithmetic and known values.

#include <gtest/gtest.h>

#include <complex>

#include "uber/reference/fresnel_exact.h"
#include "uber/reference/fresnel_fits.h"
#include "uber/reference/quadrature.h"

namespace kiln::reference {
namespace {

// The textbook form over complex numbers, for a medium of index m against air.
double from_complex(double c, std::complex<double> m) {
    const std::complex<double> root = std::sqrt(m * m - (1.0 - c * c));
    const double rs = std::norm((c - root) / (c + root));
    const double rp = std::norm((m * m * c - root) / (m * m * c + root));
    return 0.5 * (rs + rp);
}

double schlick(double c, double f0) { return fresnel_schlick_f90(c, splat3(f0), splat3(1.0)).x; }

TEST(FresnelExact, AgreesWithComplexArithmetic) {
    for (const double c : {1e-6, 0.01, 0.1, 0.3, 0.7, 1.0}) {
        for (const double n : {1.1, 1.333, 1.5, 2.417}) {
            EXPECT_NEAR(fresnel_dielectric(c, n), from_complex(c, n), 1e-14) << c << ' ' << n;
            EXPECT_NEAR(fresnel_conductor(c, n, 0.0), from_complex(c, n), 1e-14) << c << ' ' << n;
        }
        for (const std::complex<double> m : {std::complex<double>(0.18299, 3.4242), {1.3456, 7.4746}, {0.2, 3.9}, {3, 0.1}})
            EXPECT_NEAR(fresnel_conductor(c, m.real(), m.imag()), from_complex(c, m), 1e-14) << c << ' ' << m;
    }
}

TEST(FresnelExact, KnownValuesOfDielectrics) {
    const struct {
        double ior, f0, half, schlick_half, average, schlick_average, worst, at;
    } known[] = {{1.1, .002268, .013069967, .033446712, .0251574, .0497786, .210471, .1196},
                 {1.333, .020373, .059690919, .050986526, .0664058, .0670221, .059178, .1078},
                 {1.5, .04, .089186713, .07, .0917780, .0857143, .035693, .0876},
                 {2.0, .111111, .161376596, .138888889, .1605966, .1534392, .044405, .0843},
                 {2.417, .171969, .211261438, .197844807, .2121876, .2113989, .075442, .0956}};
    const TanhSinh quadrature(60);
    for (const auto& k : known) {
        const double f0 = dielectric_f0(k.ior);
        EXPECT_NEAR(f0, k.f0, 5.1e-7) << k.ior;
        EXPECT_NEAR(dielectric_ior(f0), k.ior, 1e-14);
        EXPECT_NEAR(fresnel_dielectric(1.0, k.ior), f0, 1e-15) << k.ior;
        EXPECT_NEAR(fresnel_dielectric(0.0, k.ior), 1.0, 1e-15) << k.ior;
        EXPECT_NEAR(fresnel_dielectric(0.5, k.ior), k.half, 5.1e-10) << k.ior;
        EXPECT_NEAR(schlick(0.5, f0), k.schlick_half, 5.1e-10) << k.ior;
        const double average = quadrature(0.0, 1.0, [&](double c) { return 2.0 * c * fresnel_dielectric(c, k.ior); });
        EXPECT_NEAR(average, k.average, 5.1e-8) << k.ior;
        EXPECT_NEAR(f0 + (1.0 - f0) / 21.0, k.schlick_average, 5.1e-8) << k.ior;
        double worst = 0, at = 0;
        for (int i = 0; i <= 10000; ++i) {
            const double c = i / 10000.0, error = schlick(c, f0) - fresnel_dielectric(c, k.ior);
            if (std::fabs(error) > std::fabs(worst)) worst = error, at = c;
        }
        EXPECT_NEAR(worst, k.worst, 1e-6) << k.ior;
        EXPECT_NEAR(at, k.at, 2e-4) << k.ior;
    }
}

TEST(FresnelExact, KnownValuesOfConductorsAndTheDipThatF82Fits) {
    const struct {
        double eta, k, f0, schlick_worst;
    } known[] = {{.18299, 3.4242, .944230, .018120}, {1.3456, 7.4746, .912298, .116602}, {.2, 3.9, .951952, .022152}};
    for (const auto& m : known) {
        const double f0 = fresnel_conductor(1.0, m.eta, m.k), f82 = fresnel_conductor(1.0 / 7.0, m.eta, m.k);
        EXPECT_NEAR(f0, m.f0, 5.1e-7);
        double worst_schlick = 0, worst_f82 = 0;
        for (int i = 0; i <= 10000; ++i) {
            const double c = i / 10000.0, exact = fresnel_conductor(c, m.eta, m.k);
            worst_schlick = std::fmax(worst_schlick, std::fabs(schlick(c, f0) - exact));
            worst_f82 = std::fmax(worst_f82, std::fabs(fresnel_f82(c, splat3(f0), splat3(f82)).x - exact));
        }
        EXPECT_NEAR(worst_schlick, m.schlick_worst, 1e-6) << m.eta;
        EXPECT_LT(worst_f82, 0.35 * worst_schlick) << m.eta;
        EXPECT_NEAR(fresnel_f82(1.0 / 7.0, splat3(f0), splat3(f82)).x, f82, 1e-14);
    }
}

TEST(FresnelExact, TotalReflectionAndNoContrast) {
    EXPECT_EQ(fresnel_dielectric(0.5, 0.75), 1.0);  // sin 60 / 0.75 > 1
    EXPECT_LT(fresnel_dielectric(0.9, 0.75), 0.1);
    EXPECT_EQ(fresnel_dielectric(0.0, 1.0), 0.0);
    EXPECT_EQ(fresnel_dielectric(0.3, 1.0), 0.0);
    EXPECT_NEAR(fresnel_dielectric(0.8, 1.0 + 1e-9) / (0.5e-18 * (1 + 0.28 * 0.28) / (4 * 0.8 * 0.8 * 0.8 * 0.8)), 1.0, 1e-6);
}

TEST(FresnelFits, PowIsTheMultiplicationAndTheGaussianIsNear) {
    const Vec3<double> f0{0.04, 0.5, 0.01};
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double c = i / 1000.0;
        const Vec3<double> s = fresnel_schlick(c, f0), p = fresnel_schlick_pow(c, f0);
        EXPECT_NEAR(s.x, p.x, 1e-15);
        EXPECT_NEAR(s.z, p.z, 1e-15);
        worst =
            std::fmax(worst, std::fabs(fresnel_spherical_gaussian(c, splat3(0.0001)).x - fresnel_schlick(c, splat3(0.0001)).x));
        worst = std::fmax(worst, std::fabs(fresnel_spherical_gaussian(c, f0).x - s.x) / 0.96);
    }
    EXPECT_NEAR(worst, 3.77e-3, 1e-5);
    EXPECT_GT(worst, 1e-3);  // a fit, not the thing
}

TEST(FresnelFits, PushedColoursStayFiniteAndNotNegative) {
    for (const double f0 : {-1e6, -0.1, 0.0, 0.5, 2.0, 1e6})
        for (const double c : {-1.0, 0.0, 0.5, 1.0, 1.0000002}) {
            const double f = fresnel_schlick_pushed(c, splat3(f0)).x;
            EXPECT_TRUE(std::isfinite(f)) << f0 << ' ' << c;
            EXPECT_GE(f, 0.0) << f0 << ' ' << c;
            if (f0 <= 1) {
                EXPECT_LE(f, 1.0) << f0 << ' ' << c;
            }
        }
}

}  // namespace
}  // namespace kiln::reference
