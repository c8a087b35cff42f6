// The coat over its base: the integrals that it must reproduce, energy, symmetry, darkness behind the surface.

#include "uber/reference/cook_torrance.h"

#include <gtest/gtest.h>

#include <vector>

#include "uber/reference/blinn_phong.h"
#include "uber/reference/furnace.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

const V3 black{0, 0, 0}, white{1, 1, 1}, up{0, 0, 1};

double coat_albedo(double n_dot_v, double f0, double roughness, const TanhSinh& quadrature) {
    return specular_albedo(n_dot_v, roughness * roughness, quadrature, [&](const V3& n, const V3& v, const V3& l) {
        return cook_torrance(n, v, l, black, splat3(f0), roughness).x;
    });
}

TEST(CookTorrance, ReflectsWhatTheIntegralsSay) {
    const struct {
        double roughness, n_dot_v, a, b;  // reflects F0 a + b: split-sum integrals for height-correlated Smith
    } rows[] = {{0.25, 0.50, 0.95568667, 0.03263733}, {0.50, 0.10, 0.75192990, 0.13969245}, {0.50, 0.50, 0.83491614, 0.02234730},
                {0.75, 0.25, 0.71650801, 0.02794833}, {1.00, 0.50, 0.44770512, 0.00298874}, {1.00, 1.00, 0.30681921, 0.00003361}};
    const TanhSinh quadrature(60);
    for (const auto& row : rows)
        for (const double f0 : {0.04, 1.0})  // n.l is held at 1e-4 in V, which takes as much from the integral
            EXPECT_NEAR(coat_albedo(row.n_dot_v, f0, row.roughness, quadrature), f0 * row.a + row.b, 1e-6)
                << row.roughness << " " << row.n_dot_v << " " << f0;
}

TEST(CookTorrance, HasTheKnownValue) {
    // n.v 0.8, n.l 0.6: the azimuth is chosen so that n.h is 0.95, and v.h follows.
    const double l_dot_v = 2 * std::pow(1.4 / (2 * 0.95), 2) - 1, azimuth = std::acos((l_dot_v - 0.48) / (0.6 * 0.8));
    const double f = 0.04 + 0.96 * std::pow(1 - std::sqrt((1 + l_dot_v) / 2), 5);
    const double expected = 0.839880758209 * ggx_visibility_textbook(0.6, 0.8, 0.25) * f * 0.6;
    const V3 got = cook_torrance(up, from_polar(0.8, 0), from_polar(0.6, azimuth), black, splat3(0.04), 0.5);
    EXPECT_NEAR(got.x, expected, 1e-12);
}

TEST(CookTorrance, NeverReflectsMoreThanArrives) {
    const TanhSinh quadrature(30);
    for (const double f0 : {0.0, 0.04, 0.5})
        for (const double roughness : {0.1, 0.2, 0.3, 0.4, 0.6, 1.0})
            for (const double n_dot_v : {0.05, 0.2, 0.4, 0.6, 0.8, 1.0}) {
                const double base = diffuse_albedo(n_dot_v, quadrature, [&](const V3& n, const V3& v, const V3& l) {
                    return cook_torrance(n, v, l, white, splat3(f0), roughness).x -
                           cook_torrance(n, v, l, black, splat3(f0), roughness).x;
                });
                const double kept = 1 - rough_coat_surplus(roughness * roughness) * fresnel_f90(splat3(f0));
                EXPECT_NEAR(base, (1 - fresnel_schlick(n_dot_v, splat3(f0)).x) * kept, 1e-6);
                EXPECT_LE(base + coat_albedo(n_dot_v, f0, roughness, quadrature), 1 + 1e-4)
                    << f0 << " " << roughness << " " << n_dot_v;
            }
}

// Where a rough coat reflects more than a smooth one: finely, about roughness 0.325, n.v 0.6 and F0 0.02, where dimming the base
// by F(n.v) alone gave back 1.0018 of what arrived.
TEST(CookTorrance, ReflectsNoMoreWhereItsCoatReflectsMost) {
    const TanhSinh quadrature(24);
    double most = 0, undimmed = 0;
    for (const double f0 : {0.01, 0.02, 0.025, 0.04, 0.08})
        for (double roughness = 0.1; roughness < 0.56; roughness += 0.025)
            for (double n_dot_v = 0.4; n_dot_v < 0.81; n_dot_v += 0.05) {
                const double s = rough_coat_surplus(roughness * roughness) * fresnel_f90(splat3(f0));
                const double smooth = 1 - fresnel_schlick(n_dot_v, splat3(f0)).x;
                const double coat = coat_albedo(n_dot_v, f0, roughness, quadrature);
                EXPECT_LE(smooth * (1 - s) + coat, 1 + 1e-4) << f0 << ' ' << roughness << ' ' << n_dot_v;
                most = std::max(most, smooth * (1 - s) + coat);
                undimmed = std::max(undimmed, smooth + coat);
            }
    EXPECT_NEAR(undimmed, 1.0018, 1e-4);
    EXPECT_GT(most, 0.9995);
}

TEST(CookTorrance, TheSurplusIsTakenFromTheBase) {
    const TanhSinh quadrature(30);
    for (const double f0 : {0.02, 0.04})
        for (const double roughness : {0.0625, 0.325, 0.8}) {
            const double base = diffuse_albedo(0.6, quadrature, [&](const V3& n, const V3& v, const V3& l) {
                return cook_torrance(n, v, l, white, splat3(f0), roughness).x -
                       cook_torrance(n, v, l, black, splat3(f0), roughness).x;
            });
            const double s = rough_coat_surplus(roughness * roughness) * fresnel_f90(splat3(f0));
            EXPECT_NEAR(base, (1 - fresnel_schlick(0.6, splat3(f0)).x) * (1 - s), 1e-6);
        }
}

TEST(CookTorrance, IsReciprocal) {
    for (const double roughness : {0.1, 0.6})
        for (const double azimuth : {0.3, 2.0, 3.1}) {
            const V3 a = from_polar(0.3, 0), b = from_polar(0.8, azimuth);
            const double there = cook_torrance(up, a, b, splat3(0.5), splat3(0.1), roughness).x / 0.8;
            const double back = cook_torrance(up, b, a, splat3(0.5), splat3(0.1), roughness).x / 0.3;
            EXPECT_NEAR(there, back, 1e-13 + 1e-12 * there);
        }
}

TEST(Brdfs, AreFiniteAndDarkBehindTheSurface) {
    const auto narrow = [](const V3& v) {
        return Vec3<float>{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    std::vector<Vec3<float>> directions = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}};
    for (const double c : {0.9, 1e-3, 1e-7, -1e-7, -0.5}) directions.push_back(narrow(from_polar(c, 1)));
    const Vec3<float> n{0, 0, 1};
    for (const Vec3<float>& v : directions)
        for (const Vec3<float>& l : directions)
            for (const float roughness : {0.0f, 0.045f, 1.0f, -1.0f, 3.0f}) {
                const Vec3<float> pbr = cook_torrance(n, v, l, splat3(0.8f), splat3(0.04f), roughness);
                const Vec3<float> phong = blinn_phong(n, v, l, splat3(0.8f), splat3(0.2f), roughness * 5000);
                for (const float x : {pbr.x, pbr.y, pbr.z, phong.x, phong.y, phong.z}) {
                    EXPECT_TRUE(std::isfinite(x) && x >= 0);
                    EXPECT_TRUE(l.z > 0 || x == 0);
                }
            }
}

}  // namespace
}  // namespace kiln::reference
