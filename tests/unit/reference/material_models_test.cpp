// Conversion of materials, parameters out of range, normal maps and tangent frames.

#include "uber/reference/material_models.h"

#include <gtest/gtest.h>

#include "uber/reference/lecture_brdf.h"
#include "uber/reference/normal_map.h"
#include "uber/reference/random.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(MaterialModels, ConversionKeepsWhatIsShaded) {
    const MetallicRoughness<double> m{{0.5, 0.2, 0.9}, {0, 0, 1}, 0.3, 0.25};
    const SpecularGlossiness<double> s = metallic_to_specular(m, 0.5);
    EXPECT_NEAR(s.specular.x, 0.75 * 0.04 + 0.25 * 0.5, 1e-15);
    EXPECT_NEAR(s.diffuse.y, 0.75 * 0.2, 1e-15);
    EXPECT_EQ(s.glossiness, 0.7);
    EXPECT_EQ(s.normal.z, 1.0);
    const SpecularGlossiness<double> printed = metallic_to_specular_lecture(m, 0.5);
    EXPECT_NEAR(printed.specular.z, s.specular.z, 1e-15);
    EXPECT_NEAR(printed.diffuse.z, s.diffuse.z, 1e-15);
    EXPECT_EQ(printed.normal.z, 0.0);  // the lecture forgets it
}

TEST(MaterialModels, MetallicOutOfRange) {
    const struct {
        double metallic, diffuse, specular;  // as printed
    } rows[] = {{2, -.5, .96}, {-1, 1, -.42}};
    for (const auto& row : rows) {
        const MetallicRoughness<double> m{splat3(0.5), {0, 0, 1}, 0.5, row.metallic};
        const SpecularGlossiness<double> printed = metallic_to_specular_lecture(m, 0.5), limited = metallic_to_specular(m, 0.5),
                                         pushed = metallic_to_specular_pushed(m, 0.5);
        EXPECT_NEAR(printed.diffuse.x, row.diffuse, 1e-15);
        EXPECT_NEAR(printed.specular.x, row.specular, 1e-15);
        EXPECT_NEAR(pushed.diffuse.x, std::fmax(row.diffuse, 0), 1e-15);
        EXPECT_NEAR(pushed.specular.x, std::fmax(row.specular, 0), 1e-15);
        EXPECT_NEAR(limited.diffuse.x, row.metallic > 1 ? 0 : 0.5, 1e-15);
        EXPECT_NEAR(limited.specular.x, row.metallic > 1 ? 0.5 : 0.04, 1e-15);
    }
    EXPECT_NEAR(ggx_alpha_pushed(-1.0), 0.045 * 0.045, 1e-18);
    EXPECT_EQ(ggx_alpha_pushed(1.5), 2.25);
    EXPECT_EQ(ggx_alpha_pushed(100.0), 16.0);
}

double off_orthonormal(const Mat3<double>& m) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) worst = std::fmax(worst, std::fabs(dot(m.columns[i], m.columns[j]) - (i == j)));
    return worst;
}

TEST(NormalMap, FramesAreOrthonormal) {
    Random random(3);
    const auto direction = [&] { return normalize(V3{random() - 0.5, random() - 0.5, random() - 0.5}); };
    for (int i = 0; i < 1000; ++i) {
        const V3 n = direction(), t = direction() * 1e3;
        EXPECT_LT(off_orthonormal(frame_of_normal(n)), 1e-14);
        EXPECT_NEAR(dot(cross(frame_of_normal(n).columns[0], frame_of_normal(n).columns[1]), n), 1.0, 1e-14);
        EXPECT_LT(off_orthonormal(tangent_frame(n, t, -1.0)), 1e-14);
        EXPECT_NEAR(dot(cross(tangent_frame(n, t, -1.0).columns[0], tangent_frame(n, t, -1.0).columns[1]), n), -1.0, 1e-14);
        for (const V3& none : {V3{0, 0, 0}, n, -n, n * 1e20}) EXPECT_LT(off_orthonormal(tangent_frame(n, none, 1.0)), 1e-14);
    }
    for (const double z : {1.0, -1.0}) EXPECT_LT(off_orthonormal(frame_of_normal(V3{0, 0, z})), 1e-15);
}

TEST(NormalMap, CotangentFrameFollowsTheGradientOfUv) {
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
        const V3 n = normalize(V3{random() - 0.5, random() - 0.5, random() - 0.5});
        const Mat3<double> plane = frame_of_normal(n);
        const auto across = [&](double x, double y) { return plane.columns[0] * x + plane.columns[1] * y; };
        // u = 3 x + y, v = s (2 y - x / 2) on the plane, x and y in plane coordinates; so grad u = (3, 1).
        const double s = i % 2 ? 1 : -1;
        const double ax = random() - 0.5, ay = random() + 0.1, bx = random() + 0.1, by = random() - 0.5;
        const auto uv = [&](double x, double y) { return Vec2<double>{3 * x + y, s * (2 * y - x / 2)}; };
        if (std::fabs(ax * by - ay * bx) < 1e-2) continue;
        const Mat3<double> f = cotangent_frame(n, across(ax, ay), across(bx, by), uv(ax, ay), uv(bx, by));
        const V3 gradient = normalize(across(3, 1));
        EXPECT_LT(off_orthonormal(f), 1e-13);
        EXPECT_NEAR(dot(f.columns[0], gradient), 1.0, 1e-9);
        EXPECT_NEAR(dot(cross(f.columns[0], f.columns[1]), n), s, 1e-12);
        EXPECT_LT(off_orthonormal(cotangent_frame(n, across(ax, ay), across(bx, by), uv(ax, ay), uv(2 * ax, 2 * ay))), 1e-13);
        EXPECT_LT(off_orthonormal(cotangent_frame(n, across(ax, ay), across(bx, by), Vec2<double>{}, Vec2<double>{})), 1e-13);
        EXPECT_LT(off_orthonormal(cotangent_frame(n, V3{}, V3{}, uv(ax, ay), uv(bx, by))), 1e-13);
    }
}

TEST(NormalMap, FlatTexelIsFlat) {
    const V3 flat = decode_normal_unorm8(V3{128 / 255.0, 128 / 255.0, 1.0}),
             usual = decode_normal(V3{128 / 255.0, 128 / 255.0, 1.0});
    EXPECT_NEAR(flat.x, 0.0, 1e-15);
    EXPECT_EQ(flat.z, 1.0);
    EXPECT_NEAR(usual.x, 0.00392157, 1e-8);
    EXPECT_NEAR(decode_normal(V3{127 / 255.0, 0, 0}).x, -0.00392157, 1e-8);
    EXPECT_NEAR(std::atan(std::sqrt(2.0) * usual.x) * 180 / pi, 0.318, 1e-3);  // the tilt
    EXPECT_EQ(decode_normal_unorm8(V3{0, 0, 0}).x, -1.0);
    EXPECT_NEAR(decode_normal_xy(Vec2<double>{0.6, 0.0}).z, 0.8, 1e-15);
    EXPECT_EQ(decode_normal_xy(Vec2<double>{1.0, 1.0}).z, 0.0);
    const Mat3<double> frame = frame_of_normal(V3{0, 0.6, 0.8});
    EXPECT_EQ(apply_normal(frame, V3{0, 0, 0}).z, 0.8);
    EXPECT_NEAR(apply_normal(frame, V3{0, 0, 5}).y, 0.6, 1e-15);
}

}  // namespace
}  // namespace kiln::reference
