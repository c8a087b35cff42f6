// Probe references: weights sum to 1, reproduce linear fields, and survive flat tetrahedra and rays along walls.

#include "uber/reference/probes.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln::reference {
namespace {

using V = Vec3<double>;

std::mt19937 random_bits(5);
double random_in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_bits); }
V random_vector(double size) { return {random_in(-size, size), random_in(-size, size), random_in(-size, size)}; }

TEST(Probes, TrilinearWeightsKeepLinearFields) {
    for (int i = 0; i < 200; ++i) {
        const V t{random_in(0, 1), random_in(0, 1), random_in(0, 1)};
        const std::array<double, 8> w = trilinear_weights(t);
        double sum = 0, field = 0;
        for (unsigned c = 0; c < 8; ++c) {
            EXPECT_GE(w[c], 0.0);
            sum += w[c];
            field += w[c] * (1.0 + 2.0 * (c & 1) - 3.0 * (c >> 1 & 1) + 0.5 * (c >> 2 & 1));
        }
        EXPECT_NEAR(sum, 1.0, 1e-15);
        EXPECT_NEAR(field, 1.0 + 2.0 * t.x - 3.0 * t.y + 0.5 * t.z, 1e-14);
    }
    const std::array<double, 8> outside = trilinear_weights(V{-3.0, 0.5, 2.0});
    EXPECT_EQ(outside[4], 0.5);
    EXPECT_EQ(outside[6], 0.5);
}

TEST(Probes, GridCellsHoldTheirPoints) {
    const int count[3] = {4, 1, 2};
    const GridCell inside = probe_grid_cell(V{2.5, 9.0, 0.25}, V{0.5, 0.5, 0.5}, count);
    EXPECT_EQ(inside.cell[0], 1);
    EXPECT_NEAR(inside.t[0], 0.25, 1e-15);
    EXPECT_EQ(inside.cell[1], 0);
    EXPECT_EQ(inside.t[1], 0.0);
    EXPECT_EQ(inside.cell[2], 0);
    const GridCell beyond = probe_grid_cell(V{100.0, 0.0, -5.0}, V{1, 1, 1}, count);
    EXPECT_EQ(beyond.cell[0], 2);
    EXPECT_EQ(beyond.t[0], 1.0);
    EXPECT_EQ(beyond.t[2], 0.0);
}

TEST(Probes, TetrahedronWeightsKeepLinearFields) {
    for (int i = 0; i < 500; ++i) {
        const V a = random_vector(5), b = random_vector(5), c = random_vector(5), d = random_vector(5), p = random_vector(5);
        const double size = std::max({length(b - a), length(c - a), length(d - a)});
        if (std::fabs(dot(b - a, cross(c - a, d - a))) < 1e-2 * size * size * size) continue;
        const Vec4<double> w = tetrahedron_weights(p, a, b, c, d);
        EXPECT_NEAR(w.x + w.y + w.z + w.w, 1.0, 1e-11);
        EXPECT_NEAR(length(a * w.x + b * w.y + c * w.z + d * w.w - p), 0.0, 1e-10);
        const Vec4<double> textbook = tetrahedron_weights_textbook(p, a, b, c, d);
        EXPECT_NEAR(w.x, textbook.x, 1e-11);
        EXPECT_NEAR(w.y, textbook.y, 1e-11);
        EXPECT_NEAR(w.z, textbook.z, 1e-11);
        const Vec4<double> clamped = normalize_weights(w);
        EXPECT_NEAR(clamped.x + clamped.y + clamped.z + clamped.w, 1.0, 1e-15);
        EXPECT_GE(std::min({clamped.x, clamped.y, clamped.z, clamped.w}), 0.0);
    }
    const V o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    const Vec4<double> corner = tetrahedron_weights(x, o, x, y, z);
    EXPECT_EQ(corner.y, 1.0);
    EXPECT_EQ(corner.x, 0.0);
}

TEST(Probes, FlatTetrahedraStillHaveWeights) {
    const V o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, both{1, 1, 0};
    for (const V& p : {V{0.2, 0.3, 0.1}, V{0, 0, 0}, V{-40, 2, 3}}) {
        for (const Vec4<double>& w : {tetrahedron_weights(p, o, x, y, both), tetrahedron_weights(p, o, o, o, o),
                                      tetrahedron_weights(p, o, x, x * 2.0, x * 3.0)}) {
            EXPECT_NEAR(w.x + w.y + w.z + w.w, 1.0, 1e-14);
            EXPECT_GE(std::min({w.x, w.y, w.z, w.w}), 0.0);
        }
    }
    EXPECT_NEAR(tetrahedron_weights(o, o, x, y, both).x, 1.0, 1e-5);
    EXPECT_EQ(normalize_weights(Vec4<double>{-1, 0, -3, 0}).y, 0.25);
}

TEST(Probes, BlendIsLinear) {
    const ShMomentsL1<double> a{splat3(4.0), splat3(1.0), splat3(0.0), splat3(2.0)},
        b{splat3(2.0), splat3(0.0), splat3(-1.0), splat3(0.0)};
    const ShMomentsL1<double> mid = sh_add(sh_add(ShMomentsL1<double>{}, a, 0.25), b, 0.75);
    const V n = normalize(V{1, 2, -2});
    EXPECT_NEAR(sh_irradiance_from_moments(mid, n).x,
                0.25 * sh_irradiance_from_moments(a, n).x + 0.75 * sh_irradiance_from_moments(b, n).x, 1e-14);
}

TEST(Probes, BoxProjectionMeetsTheWall) {
    const V low{-2, -1, -3}, high{4, 3, 5}, probe{1, 1, 1};
    for (int i = 0; i < 500; ++i) {
        const V p{random_in(-2, 4), random_in(-1, 3), random_in(-3, 5)}, d = normalize(random_vector(1));
        const V hit = box_projected_direction(p, d, low, high, probe) + probe;
        const double outside =
            std::max({low.x - hit.x, hit.x - high.x, low.y - hit.y, hit.y - high.y, low.z - hit.z, hit.z - high.z});
        EXPECT_NEAR(outside, 0.0, 1e-12) << "on the wall and not past it";
        EXPECT_NEAR(length(cross(hit - p, d)), 0.0, 1e-12);
    }
    // Along an axis, on the wall that the ray is parallel to, and at the probe itself.
    const V along = box_projected_direction(V{-2, 0, 0}, V{0, 1, 0}, low, high, probe);
    EXPECT_EQ(along.y, 2.0);
    EXPECT_EQ(along.x, -3.0);
    const V centre = box_projected_direction(probe, V{0, 0, -1}, low, high, probe);
    EXPECT_EQ(centre.z, -4.0);
    const V left = box_projected_direction(V{9, 0, 0}, V{1, 0, 0}, low, high, probe);
    EXPECT_EQ(left.x, 8.0) << "outside: from where it is";
}

TEST(Probes, WeightsOfBoxesAndBrightness) {
    const V low{0, 0, 0}, high{2, 2, 2};
    EXPECT_EQ(probe_box_weight(V{1, 1, 1}, low, high, 0.5), 1.0);
    EXPECT_EQ(probe_box_weight(V{0.25, 1, 1}, low, high, 0.5), 0.5);
    EXPECT_EQ(probe_box_weight(V{2, 1, 1}, low, high, 0.5), 0.0);
    EXPECT_EQ(probe_box_weight(V{-1, 1, 1}, low, high, 0.0), 0.0);
    EXPECT_EQ(probe_box_weight(V{1, 1, 1}, low, high, 0.0), 1.0);
    EXPECT_EQ(probe_facing_weight(V{0, 0, 1}, V{0, 0, 1}), 1.2);
    EXPECT_EQ(probe_facing_weight(V{0, 0, -1}, V{0, 0, 1}), 0.2);
    const V grey = splat3(1.0);
    EXPECT_NEAR(probe_normalized_reflection(grey, splat3(0.5), splat3(2.0), 4.0).x, 0.25, 1e-15);
    EXPECT_NEAR(probe_normalized_reflection(grey, splat3(50.0), splat3(2.0), 4.0).x, 4.0, 1e-15);
    EXPECT_EQ(probe_normalized_reflection(grey, splat3(1.0), splat3(0.0), 4.0).x, 1.0);
}

}  // namespace
}  // namespace kiln::reference
