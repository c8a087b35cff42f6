// The principled BRDF: directional albedos of its diffuse lobes, symmetry, limits.

#include <gtest/gtest.h>

#include <random>

#include "uber/reference/disney.h"
#include "uber/reference/furnace.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

template <class F>
double albedo_of(double n_dot_v, F lobe) {
    const TanhSinh quadrature(50);
    return diffuse_albedo(n_dot_v, quadrature, [&](const V3&, const V3& v, const V3& l) {
        return lobe(l.z, v.z, dot(l, normalize(v + l))) * l.z / pi;
    });
}

TEST(Disney, DiffuseAlbedoIsAsKnownAndNotConserving) {
    const struct {
        double roughness, n_dot_v, albedo;
    } known[] = {{0, .1, .687988},  {0, .5, .960955},  {0, 1, .976208},   {.5, .1, 1.023472}, {.5, .5, 1.008322},
                 {.5, 1, 1.005956}, {1, .1, 1.380094}, {1, .5, 1.056889}, {1, 1, 1.035703}};
    for (const auto& k : known) {
        const double albedo =
            albedo_of(k.n_dot_v, [&](double l, double v, double lh) { return disney_diffuse(l, v, lh, k.roughness); });
        // The table's own quadrature is good to 3e-5.
        EXPECT_NEAR(albedo, k.albedo, 3.2e-5) << k.roughness << ' ' << k.n_dot_v;
    }
    // Closed forms: 2 integral of (1 - c)^5 c dc = 1/21, of (1 - c)^5 c^2 dc = 1/84; (l.h)^2 = (1 + c) / 2 at v = n.
    for (const double roughness : {0.0, 0.3, 1.0}) {
        const auto burley = [&](double l, double v, double lh) { return disney_diffuse(l, v, lh, roughness); };
        EXPECT_NEAR(albedo_of(1.0, burley), 1.0 - 1.0 / 42.0 + 5.0 * roughness / 84.0, 1e-12) << roughness;
    }
    const auto smooth = [](double l, double v, double lh) { return disney_diffuse(l, v, lh, 0.0); };
    EXPECT_NEAR(albedo_of(0.1, smooth), 41.0 / 42.0 * (1.0 - 0.5 * std::pow(0.9, 5.0)), 1e-12);
}

TEST(Disney, RenormalisedDiffuseConservesUpToTheLastGrazingAngles) {
    for (const double roughness : {0.0, 0.25, 0.5, 0.75, 1.0})
        for (const double n_dot_v : {1e-6, 0.02, 0.05, 0.1, 0.5, 1.0}) {
            const double albedo = albedo_of(
                n_dot_v, [&](double l, double v, double lh) { return disney_diffuse_renormalised(l, v, lh, roughness); });
            EXPECT_LE(albedo, n_dot_v < 0.05 ? 1.0316 : 1.0) << roughness << ' ' << n_dot_v;
            EXPECT_GE(albedo, 0.0) << roughness << ' ' << n_dot_v;
        }
    // At roughness 0 it is Burley's with F90 = 0, at 1 his with the factor.
    EXPECT_NEAR(disney_diffuse_renormalised(0.3, 0.4, 0.8, 1.0), disney_diffuse(0.3, 0.4, 0.8, 1.0) / 1.51, 1e-15);
}

TEST(Disney, TintOfBlackIsWhite) {
    EXPECT_EQ(disney_tint(V3{0, 0, 0}).y, 1.0);
    EXPECT_NEAR(dot(disney_tint(V3{0.2, 0.5, 0.9}), V3{0.3, 0.6, 0.1}), 1.0, 1e-15);
}

TEST(Disney, AlphasOfLobeAndMasking) {
    EXPECT_EQ(disney_alpha(0.0), 1e-3);
    EXPECT_EQ(disney_alpha(0.5), 0.25);
    EXPECT_EQ(disney_masking_alpha(0.0), 0.25);
    EXPECT_EQ(disney_masking_alpha(1.0), 1.0);
}

TEST(Disney, WholeIsSymmetricFiniteAndNeverNegative) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(0, 1);
    const V3 n{0, 0, 1};
    for (int i = 0; i < 2000; ++i) {
        const V3 v = from_polar(0.01 + 0.99 * u(random), 6.28 * u(random)),
                 l = from_polar(0.01 + 0.99 * u(random), 6.28 * u(random));
        const DisneyMaterial<double> m{{u(random), u(random), u(random)},
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random),
                                       u(random)};
        const V3 there = disney_brdf(n, v, l, m) / l.z, back = disney_brdf(n, l, v, m) / v.z;
        EXPECT_NEAR(there.x / back.x, 1.0, 1e-11);
        EXPECT_NEAR(there.z / back.z, 1.0, 1e-11);
        EXPECT_GE(there.y, 0.0);
    }
    const DisneyMaterial<double> m{splat3(0.5), 0, 1, 1, 0, 1, 1, 1, 1, 1};
    for (const V3& v : {n, from_polar(1e-5, 0), from_polar(-0.5, 0)})
        for (const V3& l : {n, -v, v, from_polar(-1, 0), from_polar(1e-5, pi)}) {
            const V3 f = disney_brdf(n, v, l, m);
            EXPECT_TRUE(std::isfinite(f.x + f.y + f.z)) << v.z << ' ' << l.z;
            EXPECT_GE(f.x, 0.0);
        }
}

// Without the extras it is diffuse base / pi and a GTR2 lobe: against the parts put together by hand.
TEST(Disney, PlainMaterialIsDiffuseAndGtr2) {
    const V3 n{0, 0, 1}, v = from_polar(0.7, 0.3), l = from_polar(0.4, 2.0), h = normalize(v + l);
    DisneyMaterial<double> m{};
    m.base = {0.5, 0.2, 0.1};
    m.specular = 0.5, m.roughness = 0.6;
    const double lh = dot(l, h), x = 1 - lh, fresnel = 0.04 + 0.96 * x * x * x * x * x;
    const double mask = 0.64, root_l = std::sqrt(0.16 + mask * mask * 0.84), root_v = std::sqrt(0.49 + mask * mask * 0.51);
    const double expected = 0.5 * disney_diffuse(0.4, 0.7, lh, 0.6) / pi +
                            ggx_distribution_cosine(h.z, 0.36) * fresnel / ((0.4 + root_l) * (0.7 + root_v));
    EXPECT_NEAR(disney_brdf(n, v, l, m).x / 0.4 / expected, 1.0, 1e-12);
}

}  // namespace
}  // namespace kiln::reference
