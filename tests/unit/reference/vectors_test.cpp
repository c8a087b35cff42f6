// Directions and normals under scales and maps.

#include "uber/reference/vectors.h"

#include <gtest/gtest.h>

#include "uber/reference/furnace.h"
#include "uber/reference/octahedral.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(Vectors, NormalizeTakesAnyLength) {
    for (const float scale : {1.0f, 1e-20f, 1e-30f, 1e20f, 1e37f}) {
        const Vec3<float> v = safe_normalize(Vec3<float>{3 * scale, 4 * scale, 0}, Vec3<float>{0, 0, 1});
        EXPECT_NEAR(v.x, 0.6, 1e-6) << scale;
        EXPECT_NEAR(v.y, 0.8, 1e-6) << scale;
    }
    EXPECT_EQ(safe_normalize(Vec3<float>{0, 0, 0}, Vec3<float>{0, 1, 0}).y, 1.0f);
    EXPECT_EQ(safe_normalize(Vec3<float>{1e-38f, 0, 0}, Vec3<float>{0, 1, 0}).y, 1.0f);
}

TEST(Vectors, NormalsStayPerpendicularAndOutside) {
    // A plane through two edges; after any map the normal must stay perpendicular to both and on the side it was on.
    const V3 a{1.0, 0.2, 0.1}, b{-0.3, 0.9, 0.4}, n = cross(a, b);
    const Mat3<double> maps[] = {
        {{{2, 0, 0}, {0.5, 1, 0}, {0, 0.3, 3}}}, {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {{{0, -2, 0}, {1, 0, 0.5}, {0, 0, -1}}}};
    for (const Mat3<double>& m : maps) {
        const V3 moved = transform_normal(m, n);
        EXPECT_NEAR(dot(moved, m * a), 0.0, 1e-14);
        EXPECT_NEAR(dot(moved, m * b), 0.0, 1e-14);
        EXPECT_GT(dot(moved, m * n), 0.0);
    }
    const Mat3<double> flat{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}};
    EXPECT_EQ(transform_normal(flat, V3{0, 0, 1}).z, 1.0);
}

TEST(Octahedral, UnfoldsAgain) {
    for (double c = -1.0; c <= 1.0; c += 0.125)
        for (double azimuth = 0.05; azimuth < 6.28; azimuth += 0.37) {
            const V3 n = from_polar(c, azimuth);
            const Vec2<double> e = encode_octahedral(n);
            const double z = 1.0 - std::fabs(e.x) - std::fabs(e.y), t = std::max(-z, 0.0);
            const V3 back = normalize(V3{e.x + (e.x >= 0.0 ? -t : t), e.y + (e.y >= 0.0 ? -t : t), z});
            EXPECT_NEAR(dot(back, n), 1.0, 1e-14);
        }
}

}  // namespace
}  // namespace kiln::reference
