// Distributions, masking and visibility: normalisation, the weak white furnace, closed forms, energy.

#include <gtest/gtest.h>

#include "uber/reference/fresnel.h"
#include "uber/reference/furnace.h"
#include "uber/reference/ggx_forms.h"
#include "uber/reference/gtr.h"
#include "uber/reference/smith.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

double ggx_of(const V3& n, const V3& h, double alpha) {
    const V3 across = cross(n, h);
    return ggx_from_sine(dot(n, h), dot(across, across), alpha);
}

TEST(Microfacet, DistributionsAreNormalised) {
    const TanhSinh quadrature(110);
    for (const double alpha : {1e-4, 1e-3, .01, .05, .1, .25, .5, .75, 1.0}) {
        const double ggx =
            distribution_integral(alpha, quadrature, [&](const V3& n, const V3& h) { return ggx_of(n, h, alpha); });
        EXPECT_NEAR(ggx, 1.0, 1e-12) << alpha;
    }
    for (const double alpha : {2.25, 4.0, 16.0}) {
        const double pushed =
            distribution_integral(alpha, quadrature, [&](const V3& n, const V3& h) { return ggx_of(n, h, alpha); });
        EXPECT_NEAR(pushed, 1.0, 1e-12) << alpha;
    }
    for (const double alpha : {1e-3, 0.01, 0.1, 0.5, 0.8, 0.86, 0.87, 0.99, 1.0}) {
        const double gtr1 =
            distribution_integral(alpha, quadrature, [&](const V3& n, const V3& h) { return gtr1_distribution(n, h, alpha); });
        EXPECT_NEAR(gtr1, 1.0, alpha * alpha > 0.75 ? 2e-8 : 1e-12) << alpha;  // the series leaves out up to 2e-8
    }
}

TEST(Microfacet, KnownValuesOfTheDistribution) {
    const struct {
        double alpha, peak, at_45;
    } known[] = {{1e-4, 31830988.6, 1.27323952e-8}, {1e-3, 318309.886, 1.273237e-6}, {.01, 3183.09886, 1.27298494e-4},
                 {.05, 127.323954, 3.16724285e-3},  {.1, 31.8309886, .012481517},    {.25, 5.09295818, .0704907706},
                 {.5, 1.27323954, .203718327},      {.75, .565884242, .293354391},   {1, .318309886, .318309886}};
    const V3 n{0, 0, 1}, tilted{std::sqrt(0.5), 0, std::sqrt(0.5)};
    for (const auto& k : known) {
        EXPECT_NEAR(ggx_distribution_cosine(1.0, k.alpha) / k.peak, 1.0, 5e-9) << k.alpha;
        EXPECT_NEAR(ggx_distribution_cross(n, tilted, k.alpha) / k.at_45, 1.0, 2e-7) << k.alpha;
        const double sine2 = 0.5, c = 1.0 - sine2, a2 = k.alpha * k.alpha, f = c * (a2 - 1.0) + 1.0;
        EXPECT_NEAR(ggx_from_sine(std::sqrt(c), sine2, k.alpha) / (a2 / (pi * f * f)), 1.0, 1e-13) << k.alpha;
    }
}

TEST(Microfacet, LogRatioAndItsSeries) {
    for (const double u : {1e-12, 1e-3, 0.1, 0.2499, 0.25, 0.7, 0.999})
        EXPECT_NEAR(log_ratio(u) / (-std::log1p(-u) / u), 1.0, 2e-8) << u;
}

TEST(Smith, LambdaIsThePlainFormWhereThatIsUsable) {
    for (const double alpha : {1e-4, 0.002, 0.1, 1.0, 4.0})
        for (const double c : {1e-3, 0.1, 0.5, 0.9}) {
            const long double q = static_cast<long double>(alpha) * alpha * (1.0L - static_cast<long double>(c) * c) / c / c;
            const long double plain = 0.5L * (std::sqrt(1.0L + q) - 1.0L);
            EXPECT_NEAR(static_cast<double>(smith_lambda(c, alpha) / plain), 1.0, 2e-9) << alpha << ' ' << c;
            EXPECT_NEAR(smith_g1(c, alpha), 1.0 / (1.0 + smith_lambda(c, alpha)), 1e-15) << alpha << ' ' << c;
        }
    EXPECT_NEAR(smith_lambda(0.9, 1e-3) / 5.8642e-8, 1.0, 1e-4);
    EXPECT_TRUE(std::isfinite(smith_lambda(1e-18, 16.0)));
    EXPECT_GT(smith_g1(1e-18, 1.0), 0.0);
}

// The projected area of the visible facets is that of the surface: integral of G1 D max(0, v.h) dh = n.v.
TEST(Smith, VisibleFacetsCoverTheSurface) {
    const TanhSinh quadrature(110);
    for (const double alpha : {0.01, 0.1, 0.5, 1.0})
        for (const double n_dot_v : {0.05, 0.3, 0.8, 1.0}) {
            const double sin_v = std::sqrt(1.0 - n_dot_v * n_dot_v);
            const auto ring = [&](double w) {  // the whole circle of h, cut where v.h = 0
                const double t = alpha * std::tan(w), cos_h = 1.0 / std::sqrt(1.0 + t * t), sin_h = t * cos_h;
                const double edge = std::fmin(std::fmax(-n_dot_v * cos_h / (sin_v * sin_h + 1e-300), -1.0), 1.0);
                const double sum =
                    quadrature(0.0, std::acos(edge), [&](double phi) { return n_dot_v * cos_h + sin_v * sin_h * std::cos(phi); });
                return 2.0 / pi * std::sin(w) * std::cos(w) / cos_h * sum;
            };
            const double kink = std::atan(n_dot_v / (sin_v + 1e-300) / alpha);  // theta_h = pi/2 - theta_v
            const double area = quadrature(0.0, kink, ring) + quadrature(kink, 0.5 * pi, ring);
            EXPECT_NEAR(smith_g1(n_dot_v, alpha) * area / n_dot_v, 1.0, 1e-9) << alpha << ' ' << n_dot_v;
        }
}

TEST(Visibility, KnownValues) {
    EXPECT_NEAR(visibility_height_correlated_pushed(0.1, 0.1, 0.25), 9.32504808, 5e-9);
    EXPECT_NEAR(visibility_karis_ibl(0.1, 0.1, 0.25), 5.53633218, 5e-9);
    EXPECT_NEAR(visibility_karis_direct(0.1, 0.1, 0.5), 2.00485551, 5e-9);
    // The exact G1 of alpha 1 is Schlick's with k = 1/2.
    EXPECT_NEAR(visibility_separable(0.3, 0.7, 1.0), visibility_karis_ibl(0.3, 0.7, 1.0), 1e-15);
    EXPECT_NEAR(visibility_karis_ibl(0.0, 0.0, 0.25), 16.0, 1e-13);  // 1 / alpha^2
    // Without roughness Hammon's fit and the exact one are 1 / (4 n.l n.v).
    EXPECT_NEAR(visibility_hammon(0.3, 0.7, 0.0), 0.25 / 0.21, 1e-15);
    EXPECT_NEAR(visibility_hammon(0.3, 0.7, 1.0), visibility_height_correlated_pushed(0.3, 0.7, 1.0), 1e-15);
    EXPECT_NEAR(visibility_kelemen(0.5), 1.0, 1e-15);
    EXPECT_NEAR(visibility_kelemen(0.0), 0.25e8, 1e-6);
}

TEST(Visibility, IsTheMaskingOverTheDenominator) {
    for (const double roughness : {0.1, 0.5, 1.0})
        for (const double l : {0.05, 0.4, 1.0})
            for (const double v : {0.02, 0.6}) {
                const double alpha = roughness * roughness, over = 4.0 * l * v;
                const auto g = [&](SmithForm form) { return smith_g2(form, l, v, roughness); };
                EXPECT_NEAR(visibility_separable(l, v, alpha) * over, g(SmithForm::separable), 1e-14);
                EXPECT_NEAR(visibility_height_correlated_pushed(l, v, alpha) * over, g(SmithForm::height_correlated), 1e-14);
                EXPECT_NEAR(visibility_karis_ibl(l, v, alpha) * over, g(SmithForm::karis_ibl), 1e-14);
                EXPECT_NEAR(visibility_karis_direct(l, v, roughness) * over, g(SmithForm::karis_direct), 1e-14);
                EXPECT_EQ(visibility_separable(l, v, alpha), visibility_separable(v, l, alpha));
                EXPECT_EQ(visibility_hammon(l, v, alpha), visibility_hammon(v, l, alpha));
            }
}

// D V with F = 1 in the furnace of furnace.h, which integrates the BRDF as a shader has it, is the A + B of the split sum;
// and never above 1, for a roughness pushed beyond 1 neither.
TEST(Microfacet, FurnaceOfTheLobeIsTheSplitSum) {
    const TanhSinh quadrature(50);
    for (const double roughness : {0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0})
        for (const double n_dot_v : {0.05, 0.5, 1.0}) {
            const double alpha = roughness * roughness;
            const auto albedo = [&](double f0, double f90) {
                return specular_albedo(n_dot_v, alpha, quadrature, [&](const V3& n, const V3& v, const V3& l) {
                    const V3 h = normalize(v + l);
                    const double x = 1.0 - saturate(dot(v, h)), x5 = x * x * x * x * x;
                    return ggx_of(n, h, alpha) * visibility_height_correlated_pushed(l.z, v.z, alpha) * (f0 + (f90 - f0) * x5) *
                           l.z;
                });
            };
            const double white = albedo(1, 1);
            EXPECT_LE(white, 1.0 + 1e-9) << roughness << ' ' << n_dot_v;
            EXPECT_GT(white, 0.0);
            if (roughness <= 1) {
                const SplitSum s = split_sum(SmithForm::height_correlated, n_dot_v, roughness, quadrature);
                EXPECT_NEAR(white, s.a + s.b, 1e-9) << roughness << ' ' << n_dot_v;
                EXPECT_NEAR(albedo(0.04, 1), 0.04 * s.a + s.b, 1e-9) << roughness << ' ' << n_dot_v;
            }
        }
}

// The same sample as three lobes: what the lecture's alpha = roughness costs.
TEST(Microfacet, SampleOfAWholeLobe) {
    const double f = 0.04 + 0.96 * std::pow(0.25, 5.0), l = 0.6, v = 0.8, cosine = 0.95;
    const double d = ggx_distribution_cosine(cosine, 0.25);
    EXPECT_NEAR(d, 0.839880758, 5e-10);
    EXPECT_NEAR(d * visibility_karis_direct(l, v, 0.5) * f, 0.014089433, 5e-10);
    EXPECT_NEAR(d * visibility_height_correlated_pushed(l, v, 0.25) * f, 0.017289356, 5e-10);
}

}  // namespace
}  // namespace kiln::reference
