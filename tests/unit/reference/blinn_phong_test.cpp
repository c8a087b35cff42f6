// Normalised Blinn-Phong against the closed form of its integral.

#include "uber/reference/blinn_phong.h"

#include <gtest/gtest.h>

#include "uber/reference/furnace.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

double albedo(double shininess, double n_dot_v) {
    const TanhSinh quadrature(60);
    return diffuse_albedo(n_dot_v, quadrature, [&](const V3& n, const V3& v, const V3& l) {
        return blinn_phong(n, v, l, splat3(0.0), splat3(1.0), shininess).x;
    });
}

TEST(BlinnPhong, ReflectsExactlyItsSpecularColourFromTheFront) {
    for (const double p : {1.0, 10.0, 100.0}) EXPECT_NEAR(albedo(p, 1.0), 1.0, 1e-9) << p;
    EXPECT_LT(albedo(10.0, 0.5), 0.5);
    EXPECT_LT(albedo(10.0, 0.866), 0.9);
}

TEST(BlinnPhong, NormalizationIsTheInverseOfTheKnownIntegrals) {
    const struct {
        double shininess, integral;
    } rows[] = {{1, 2.860284865}, {10, 1.500671491}, {50, 0.447520321}, {100, 0.236922523}, {1000, 0.024982645}};
    for (const auto& row : rows) EXPECT_NEAR(blinn_phong_normalization(row.shininess) * row.integral, 1, 3e-8) << row.shininess;
}

TEST(BlinnPhong, HasTheLobeWidthOfItsRoughness) {
    EXPECT_NEAR(blinn_phong_roughness(6.0), std::sqrt(0.5), 1e-15);  // alpha 1/2
    EXPECT_NEAR(blinn_phong_roughness(198.0), std::sqrt(0.1), 1e-15);
}

TEST(BlinnPhong, TakesTheHighlightFromTheDiffusePart) {
    const V3 n{0, 0, 1};
    const V3 away = blinn_phong(n, from_polar(0.5, 0), from_polar(0.5, 0), splat3(1.0), V3{0.25, 0.1, 0}, 2048.0);
    EXPECT_NEAR(away.x, 0.75 / pi * 0.5, 1e-12) << "the lobe is too narrow to be seen here";
}

}  // namespace
}  // namespace kiln::reference
