// Whole BRDFs in a white furnace, and what the stand-ins for Smith's masking cost there.

#include "uber/reference/furnace.h"

#include <gtest/gtest.h>

#include "uber/reference/cook_torrance.h"
#include "uber/reference/ggx.h"
#include "uber/reference/smith.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(Furnace, LambertReflectsItsAlbedoInEitherParametrisation) {
    const TanhSinh quadrature(60);
    const auto lambert = [](const V3&, const V3&, const V3& l) { return 0.7 / pi * l.z; };
    for (const double n_dot_v : {0.05, 0.5, 1.0}) {
        EXPECT_NEAR(diffuse_albedo(n_dot_v, quadrature, lambert), 0.7, 1e-12);
        for (const double alpha : {0.3, 1.0})
            EXPECT_NEAR(specular_albedo(n_dot_v, alpha, quadrature, lambert), 0.7, 1e-9) << n_dot_v;
    }
}

// A white base below a coat of every roughness and f0 reflects at most what arrives. The model is exact for a smooth coat; a
// rough one takes at least as much from the base as it reflects more than that.
TEST(Furnace, CookTorranceConserves) {
    const TanhSinh quadrature(40);
    for (const double roughness : {0.1, 0.25, 0.325, 0.5, 0.75, 1.0})
        for (const double f0 : {0.0, 0.02, 0.04, 0.3, 1.0})
            for (const double n_dot_v : {0.02, 0.1, 0.5, 0.6, 1.0}) {
                const double albedo = specular_albedo(n_dot_v, roughness * roughness, quadrature,
                                                      [&](const V3& n, const V3& v, const V3& l) {
                                                          return cook_torrance(n, v, l, splat3(0.0), splat3(f0), roughness).x;
                                                      }) +
                                      diffuse_albedo(n_dot_v, quadrature, [&](const V3& n, const V3& v, const V3& l) {
                                          return cook_torrance(n, v, l, splat3(1.0), splat3(f0), roughness).x -
                                                 cook_torrance(n, v, l, splat3(0.0), splat3(f0), roughness).x;
                                      });
                EXPECT_LE(albedo, 1 + 1e-4) << roughness << ' ' << f0 << ' ' << n_dot_v;
            }
}

TEST(Furnace, StandInsForSmith) {
    const TanhSinh quadrature(40);
    const auto albedo = [&](double n_dot_v, double roughness, auto visibility) {
        const double alpha = roughness * roughness;
        return specular_albedo(n_dot_v, alpha, quadrature, [&](const V3& n, const V3& v, const V3& l) {
            const V3 h = normalize(v + l);
            return ggx_distribution(n, h, alpha) * visibility(l.z, v.z, dot(v, h)) * l.z;
        });
    };
    for (const double roughness : {0.1, 0.5, 1.0})
        for (const double n_dot_v : {0.1, 0.5, 1.0}) {
            const double alpha = roughness * roughness;
            const auto split = [&](SmithForm form) {
                const SplitSum s = split_sum(form, n_dot_v, roughness, quadrature);
                return s.a + s.b;
            };
            const double exact = split(SmithForm::height_correlated);
            const double separable =
                albedo(n_dot_v, roughness, [&](double l, double v, double) { return visibility_separable(l, v, alpha); });
            const double ibl =
                albedo(n_dot_v, roughness, [&](double l, double v, double) { return visibility_karis_ibl(l, v, alpha); });
            const double direct =
                albedo(n_dot_v, roughness, [&](double l, double v, double) { return visibility_karis_direct(l, v, roughness); });
            const double hammon =
                albedo(n_dot_v, roughness, [&](double l, double v, double) { return visibility_hammon(l, v, alpha); });
            const double kelemen = albedo(n_dot_v, roughness, [&](double, double, double vh) { return visibility_kelemen(vh); });
            const double implicit =
                albedo(n_dot_v, roughness, [&](double, double, double) { return visibility_implicit<double>(); });
            EXPECT_NEAR(separable, split(SmithForm::separable), 1e-9);
            EXPECT_NEAR(ibl, split(SmithForm::karis_ibl), 1e-9);
            EXPECT_NEAR(direct, split(SmithForm::karis_direct), 1e-9);
            for (const double e : {separable, ibl, direct, hammon, kelemen, implicit}) {
                EXPECT_LE(e, 1.0) << roughness << ' ' << n_dot_v;
            }
            EXPECT_LE(direct, ibl + 1e-12);
            EXPECT_LE(ibl, separable + 1e-12);
            EXPECT_LE(separable, exact + 1e-12);
            // Nearer than Hammon's fit, though it knows no roughness, but for a frontal view.
            if (n_dot_v < 1) {
                EXPECT_LE(std::fabs(kelemen - exact), std::fabs(hammon - exact) + 1e-9) << roughness << ' ' << n_dot_v;
            }
            if (roughness == 1.0) {
                EXPECT_NEAR(implicit, 0.25, 1e-9);  // D V = 1 / (4 pi) over the hemisphere
                EXPECT_NEAR(hammon, exact, 1e-9);
            }
        }
}

// The k of analytic lights in an integral over the hemisphere.
TEST(Furnace, DirectKInAnIntegralIsFarTooDark) {
    const TanhSinh quadrature(40);
    const auto e = [&](SmithForm form) {
        const SplitSum s = split_sum(form, 0.1, 0.1, quadrature);
        return s.a + s.b;
    };
    EXPECT_NEAR(e(SmithForm::karis_direct), 0.18265, 5.1e-6);
    EXPECT_NEAR(e(SmithForm::karis_ibl), 0.91437, 5.1e-6);
    EXPECT_NEAR(e(SmithForm::height_correlated), 0.99412, 5.1e-6);
}

}  // namespace
}  // namespace kiln::reference
