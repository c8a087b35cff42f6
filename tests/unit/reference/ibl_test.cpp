// Image-based light: samples against densities, sampled tables against quadrature, energy, and the fits' known errors.

#include "uber/reference/ibl.h"

#include <gtest/gtest.h>

#include "uber/reference/ibl_bake.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::reference {
namespace {

using V = Vec3<double>;

double fifth(double x) { return x * x * x * x * x; }

TEST(IblBake, HammersleyFillsTheSquare) {
    EXPECT_EQ(radical_inverse(1), 0.5);
    EXPECT_EQ(radical_inverse(6), 0.375);
    EXPECT_LT(radical_inverse(0xffffffffu), 1.0);
    double mean = 0;
    for (uint32_t i = 0; i < 64; ++i) mean += hammersley(i, 64).x * hammersley(i, 64).y / 64;
    EXPECT_NEAR(mean, 0.25, 1.0 / 64);
}

TEST(IblBake, FramesAreRightHandedAndHoldTheNormal) {
    for (const V& n : {V{0, 0, 1}, V{0, 0, -1}, normalize(V{1, -2, 1e-9}), normalize(V{-1, 0.3, -0.2})}) {
        const Mat3<double> m = frame_around(n);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(dot(m.columns[i], m.columns[j]), i == j, 1e-15);
        }
        EXPECT_NEAR(dot(cross(m.columns[0], m.columns[1]), n), 1.0, 1e-15);
    }
}

// Shares of samples within an angle are the integrals of the densities: sin^2 for the cosine, and for GGX's D n.h
// tan^2 / (a^2 + tan^2).
TEST(IblBake, SamplesHaveTheirDensities) {
    constexpr uint32_t count = 4096;
    for (const double angle : {0.2, 0.7, 1.2}) {
        for (const double alpha : {0.05, 0.3, 1.0}) {
            double cosine_inside = 0, ggx_inside = 0;
            for (uint32_t i = 0; i < count; ++i) {
                cosine_inside += sample_cosine(hammersley(i, count)).z >= std::cos(angle);
                ggx_inside += sample_ggx_half(hammersley(i, count), alpha).z >= std::cos(angle);
            }
            const double t2 = std::tan(angle) * std::tan(angle);
            EXPECT_NEAR(cosine_inside / count, std::sin(angle) * std::sin(angle), 1.5 / count);
            EXPECT_NEAR(ggx_inside / count, t2 / (alpha * alpha + t2), 1.5 / count);
        }
    }
}

TEST(IblBake, LevelsFollowColbertAndKrivanek) {
    // A uniform density over the sphere with as many samples as texels reads level 0; 64 times fewer, level 3.
    EXPECT_NEAR(filtered_lod(1.0 / (4.0 * pi), 6.0 * 64 * 64, 64.0), 0.0, 1e-12);
    EXPECT_NEAR(filtered_lod(1.0 / (4.0 * pi), 6.0 * 64, 64.0), 3.0, 1e-12);
    EXPECT_EQ(filtered_lod(1e9, 1e6, 64.0), 0.0);
}

// N = 1024 points against quadrature: known to be off by at most .0047 in A.
TEST(IblBake, SampledSplitSumIsNearTheQuadrature) {
    const TanhSinh quadrature(60);
    double worst_a = 0, worst_b = 0;
    for (const double r : {0.1, 0.25, 0.5, 0.75, 1.0}) {
        for (const double n_dot_v : {0.1, 0.25, 0.5, 0.75, 1.0}) {
            const SplitSum truth = split_sum(SmithForm::karis_ibl, n_dot_v, r, quadrature);
            const Vec2<double> sampled = split_sum_sampled(
                n_dot_v, r * r, 1024, [&](double l, double v) { return smith_g2(SmithForm::karis_ibl, l, v, r) / (4.0 * l * v); },
                [](double, double v_dot_h) { return fifth(1.0 - v_dot_h); });
            worst_a = std::max(worst_a, std::fabs(sampled.x - truth.a));
            worst_b = std::max(worst_b, std::fabs(sampled.y - truth.b));
        }
    }
    EXPECT_LT(worst_a, 0.0047);
    EXPECT_LT(worst_b, 0.001);
}

// The lecture's Fresnel weight, by quadrature: F0 = 0.04 albedo too large by the specification's figures.
TEST(Ibl, LectureFresnelWeightIsTooBright) {
    const TanhSinh quadrature(60);
    const struct {
        double r, n_dot_v, lecture, right;
    } rows[] = {{0.5, 0.5, 0.087685, 0.055744}, {0.5, 1.0, 0.051854, 0.036659}, {1.0, 0.1, 0.108434, 0.053321}};
    for (const auto& row : rows) {
        const SplitSum wrong = split_sum(
            row.n_dot_v, row.r * row.r, quadrature,
            [&](double l, double v) { return smith_g2(SmithForm::height_correlated, l, v, row.r); },
            [](const LobeCosines& c) { return fifth(1.0 - c.n_dot_l); });
        const SplitSum right = split_sum(SmithForm::height_correlated, row.n_dot_v, row.r, quadrature);
        EXPECT_NEAR(0.04 * wrong.a + wrong.b, row.lecture, 1e-6);
        EXPECT_NEAR(0.04 * right.a + right.b, row.right, 1e-6);
    }
}

// Over r in [.05, 1] and n.v in [.02, .99], against the form that it fits.
TEST(Ibl, FitIsAsFarOffAsKnown) {
    const TanhSinh quadrature(24);
    double worst_a = 0, worst_b = 0;
    for (int i = 0; i <= 20; ++i) {
        for (int j = 0; j <= 20; ++j) {
            const double r = 0.05 + 0.95 * i / 20, n_dot_v = 0.02 + 0.97 * j / 20;
            const SplitSum truth = split_sum(SmithForm::karis_ibl, n_dot_v, r, quadrature);
            const Vec2<double> fit = split_sum_fit(n_dot_v, r);
            worst_a = std::max(worst_a, std::fabs(fit.x - truth.a));
            worst_b = std::max(worst_b, std::fabs(fit.y - truth.b));
        }
    }
    EXPECT_LT(worst_a, 0.181);
    EXPECT_GT(worst_a, 0.17);
    EXPECT_LT(worst_b, 0.194);
    EXPECT_GT(worst_b, 0.17);
}

TEST(Ibl, TablesAreReadAtTheirTexels) {
    for (const int size : {2, 32}) {
        for (int i = 0; i < size; ++i) {
            const Vec2<double> p = split_sum_texel(i, size - 1 - i, size), uv = split_sum_uv(p.x, p.y, static_cast<double>(size));
            EXPECT_NEAR(uv.x, (i + 0.5) / size, 1e-15);
            EXPECT_NEAR(uv.y, (size - 0.5 - i) / size, 1e-15);
        }
    }
}

// A furnace of 1: a white metal reflects all with either compensation, a white base under any coat exactly 1, nothing more.
TEST(Ibl, FurnaceKeepsEnergy) {
    const TanhSinh quadrature(24);
    const V one = splat3(1.0), none = splat3(0.0);
    for (const double r : {0.1, 0.5, 1.0}) {
        for (const double n_dot_v : {0.05, 0.5, 1.0}) {
            const SplitSum s = split_sum(SmithForm::height_correlated, n_dot_v, r, quadrature);
            const Vec2<double> ab{s.a, s.b};
            EXPECT_NEAR(environment_specular_multiscatter(one, one, ab).x, 1.0, 1e-12);
            EXPECT_NEAR(image_based_light(none, one, one, one, ab).x, 1.0, 1e-12);
            for (const double f0 : {0.0, 0.02, 0.04, 0.5}) {
                EXPECT_NEAR(image_based_light(one, splat3(f0), one, one, ab).x, 1.0, 1e-12);
                const double grey = image_based_light(splat3(0.5), splat3(f0), one, one, ab).x;
                EXPECT_LE(grey, 1.0);
                EXPECT_GE(grey, 0.5 - 1e-12);
            }
        }
    }
}

}  // namespace
}  // namespace kiln::reference
