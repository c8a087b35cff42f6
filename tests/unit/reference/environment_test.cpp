// Environment look-up references: the lecture's sign, cube faces, solid angles, poles and seams, energy of a split sun.

#include "uber/reference/environment.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln::reference {
namespace {

using V = Vec3<double>;

TEST(Environment, ReflectionLooksAwayFromTheViewer) {
    const V n{0, 0, 1}, v{0.6, 0, 0.8};
    const V right = environment_reflection(n, v), lecture = environment_reflection_lecture(n, v);
    EXPECT_NEAR(right.x, -0.6, 1e-15);
    EXPECT_NEAR(right.z, 0.8, 1e-15);
    EXPECT_NEAR(lecture.x, 0.6, 1e-15);
    EXPECT_NEAR(lecture.z, -0.8, 1e-15);
    EXPECT_NEAR(length(right + lecture), 0.0, 1e-15);
}

TEST(Environment, LevelFollowsRoughness) {
    EXPECT_EQ(environment_lod(0.5, 9.0), 4.0);
    EXPECT_EQ(environment_lod(2.0, 9.0), 8.0);
    EXPECT_EQ(environment_lod(-1.0, 9.0), 0.0);
    EXPECT_EQ(environment_lod(1.0, 0.0), 0.0);
    const auto map = [](const V& d, double lod) { return V{d.y, lod, 0.0}; };
    EXPECT_EQ(sample_environment(map, V{0, 0, 0}, 0.5, 5.0).x, 1.0);
    EXPECT_EQ(sample_environment(map, V{0, 0, 2}, 0.5, 5.0).y, 2.0);
}

TEST(Environment, CubeFacesGoThereAndBack) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> side(-1.0, 1.0);
    for (int i = 0; i < 1000; ++i) {
        const int face = i % 6;
        const Vec2<double> p{side(random), side(random)};
        const V d = cube_direction(face, p) * 3.0;
        ASSERT_EQ(cube_face(d), face);
        const Vec2<double> q = cube_face_coordinates(d, face);
        EXPECT_NEAR(q.x, p.x, 1e-14);
        EXPECT_NEAR(q.y, p.y, 1e-14);
    }
    EXPECT_EQ(cube_face(V{1, 1, 1}), 4);
    EXPECT_EQ(cube_face(V{-1, -1, 0.5}), 3);
    // The middle of each face looks along its axis; a step to the right on +x goes to -z.
    EXPECT_EQ(cube_direction(0, Vec2<double>{0, 0}).x, 1.0);
    EXPECT_EQ(cube_direction(0, Vec2<double>{0.5, 0}).z, -0.5);
    EXPECT_EQ(cube_direction(2, Vec2<double>{0, 0.5}).z, 0.5);
}

TEST(Environment, TexelsMakeASphere) {
    for (const int size : {4, 16, 64}) {
        double sum = 0, exact = 0, worst = 0;
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const double h = 1.0 / size;
                const Vec2<double> p = cube_texel_centre<double>(x, y, size);
                const double truth = cube_rectangle_solid_angle(p - h, p + h);
                const double midpoint = cube_texel_solid_angle(p, static_cast<double>(size));
                worst = std::max(worst, std::fabs(midpoint / truth - 1.0));
                sum += 6 * midpoint;
                exact += 6 * truth;
            }
        }
        EXPECT_NEAR(exact, 4.0 * pi, 1e-12);
        EXPECT_LT(worst, 1.0 / (size * size));
        EXPECT_LT(std::fabs(sum / (4.0 * pi) - 1.0), 0.4 / (size * size));
    }
}

TEST(Environment, EquirectGoesThereAndBackAndKnowsItsPoles) {
    std::mt19937 random(12);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 1000; ++i) {
        const Vec2<double> uv{unit(random), unit(random)}, back = equirect_uv(equirect_direction(uv) * 7.0);
        EXPECT_NEAR(back.x, uv.x, 1e-12);
        EXPECT_NEAR(back.y, uv.y, 1e-12);
    }
    const Vec2<double> top = equirect_uv(V{0, 2, 0}), bottom = equirect_uv(V{0, -1, 0});
    EXPECT_EQ(top.x, 0.5);
    EXPECT_EQ(top.y, 0.0);
    EXPECT_EQ(bottom.y, 1.0);
    const auto row = [](const Vec2<double>& uv, double) { return V{uv.y, 0, 0}; };
    EXPECT_EQ(sample_equirect(row, V{0, 1, 0}, 0.0, 8.0).x, 1.0 / 16.0) << "the middle of the first row";
    EXPECT_EQ(sample_equirect(row, V{0, -1, 0}, 0.0, 8.0).x, 15.0 / 16.0);
    // Across the seam behind -x, u jumps by a whole picture and repeats.
    const double left = equirect_uv(V{-1, 0, 1e-12}).x, right = equirect_uv(V{-1, 0, -1e-12}).x;
    EXPECT_NEAR(left - right, 1.0, 1e-11);
}

// What is cut from the map is what the light gives: radiance clamped plus excess is radiance, whatever the limit.
TEST(Environment, SplitSunKeepsItsEnergy) {
    const double size = 64;
    for (const double limit : {1.0, 100.0, 65504.0}) {
        V kept{}, cut{}, all{};
        for (int i = 0; i < 64; ++i) {
            const V radiance{i == 20 ? 1.6e9 : 0.5 + i, i == 20 ? 1.4e9 : 0.2, 3.0 * i};
            const double sr = cube_texel_solid_angle(cube_texel_centre<double>(i, 7, 64), size);
            kept = kept + environment_clamped(radiance, limit) * sr;
            cut = cut + environment_excess(radiance, limit) * sr;
            all = all + radiance * sr;
        }
        EXPECT_NEAR(kept.x + cut.x, all.x, 1e-12 * all.x);
        EXPECT_NEAR(kept.y + cut.y, all.y, 1e-12 * all.y);
        EXPECT_NEAR(kept.z + cut.z, all.z, 1e-12 * all.z);
        EXPECT_LE(kept.x, limit * 4.0 * pi);
    }
}

}  // namespace
}  // namespace kiln::reference
