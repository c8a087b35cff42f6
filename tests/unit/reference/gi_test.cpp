// References of indirect light against form factors, furnaces, and one another.

#include "uber/reference/gi_truth.h"

#include <gtest/gtest.h>

#include "uber/reference/gi_ambient.h"
#include "uber/reference/gi_cones.h"
#include "uber/reference/gi_cornell.h"
#include "uber/reference/gi_rsm.h"
#include "uber/reference/gi_screen.h"

namespace kiln::reference {
namespace {

const GiLamp<double> dark{{0, 5, 0}, {0, -1, 0}, {}};

TEST(GiTruth, FormFactorsHaveThePrintedValuesAndCloseTheCube) {
    const double facing = form_factor_parallel(1, 1, 1), beside = form_factor_perpendicular(1, 1, 1);
    EXPECT_NEAR(facing, 0.199824896, 5e-10);
    EXPECT_NEAR(beside, 0.200043776, 5e-10);
    EXPECT_NEAR(4 * beside + facing, 1, 1e-14);
}

TEST(GiTruth, PlatesExchangeTheirFormFactor) {
    const auto plates = gi_plate_quads();
    // The mean irradiance of the lower plate from the upper, by Lambert's formula at midpoints: an error of order step^2.
    double sum = 0;
    const int n = 40;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            sum += polygon_irradiance({(i + 0.5) / n - 0.5, -0.5, (j + 0.5) / n - 0.5}, {0, 1, 0}, plates[1]);
    EXPECT_NEAR(sum / n / n / pi, form_factor_parallel(1, 1, 1), 1e-4);
    // Paths from one point meet the same.
    const auto traced = gi_irradiance(plates, dark, {0.2, -0.5, -0.1}, {0, 1, 0}, 0, 40000, 1);
    const double exact = polygon_irradiance({0.2, -0.5, -0.1}, {0, 1, 0}, plates[1]);
    std::printf("plates: exact %.6f traced %.6f +- %.6f\n", exact, traced[0].mean, traced[0].standard_error);
    EXPECT_NEAR(traced[0].mean, exact, 4.5 * traced[0].standard_error);
}

TEST(GiTruth, FurnaceIsTheGeometricSeriesWithoutNoise) {
    for (const double albedo : {0.5, 0.9})
        for (const int bounces : {0, 1, 2, 10}) {
            const auto room = gi_furnace_quads(albedo);
            const auto traced = gi_irradiance(room, dark, {0.3, -1, 0.2}, {0, 1, 0}, bounces, 200, 2);
            const double series = interreflection(splat3(1.0), splat3(albedo), bounces).y;
            EXPECT_NEAR(traced[1].mean / pi, series, 1e-12);
            EXPECT_NEAR(interreflection_textbook(splat3(1.0), splat3(albedo), bounces).y, series, 1e-12);
            EXPECT_NEAR(traced[1].standard_error, 0, 1e-12);
        }
    EXPECT_NEAR(interreflection(splat3(1.0), splat3(0.9), 10).x, 6.861894039, 5e-10);
    EXPECT_NEAR(interreflection(splat3(1.0), splat3(0.5), 2).x, 1.75, 1e-15);
    EXPECT_NEAR(interreflection_limit(splat3(1.0), splat3(0.9)).x, 10, 1e-13);
    EXPECT_NEAR(interreflection(splat3(1.0), splat3(1.0), 7).x, 8, 0);
}

TEST(GiTruth, CornellBoxIsClosedButForItsFrontAndTracesAlikeWithBothGenerators) {
    const auto room = gi_cornell_quads();
    const auto lamp = gi_cornell_lamp();
    EXPECT_EQ(room.size(), 15u);
    const Vec3<double> x{0.8, -1, 0.8}, n{0, 1, 0};
    const auto traced = gi_irradiance(room, lamp, x, n, 1, 20000, 3);
    Samples other;
    uint32_t state = 7;
    for (int i = 0; i < 20000; ++i) {
        const double a = gi_random(state), b = gi_random(state);
        const auto direction = gi_cosine_direction<double>({a, b}, n);
        other.add(pi * gi_path(room, lamp, x, direction, 1, [&] { return gi_random(state); }).y);
    }
    std::printf("cornell: %.6f +- %.6f, %.6f +- %.6f\n", traced[1].mean, traced[1].standard_error, other.estimate().mean,
                other.estimate().standard_error);
    EXPECT_NEAR(traced[1].mean, other.estimate().mean,
                4.5 * std::hypot(traced[1].standard_error, other.estimate().standard_error));
    EXPECT_GT(traced[1].mean, 0.0);
    // Every wall faces the room's middle, every side of a block away from the block's.
    for (std::size_t i = 0; i < room.size(); ++i) {
        const Vec3<double> middle = room[i].origin + room[i].u * 0.5 + room[i].v * 0.5;
        const Vec3<double> block = i < 10 ? Vec3<double>{0.35, -0.7, 0.35} : Vec3<double>{-0.4, -0.4, -0.3};
        const double facing = dot(cross(room[i].u, room[i].v), middle - (i < 5 ? Vec3<double>{} : block));
        EXPECT_TRUE(i < 5 ? facing < 0 : facing > 0) << i;
    }
}

TEST(GiTruth, LatticesAgreeWithIndependentPathsAndKnowMore) {
    const Vec3<double> n{0, 1, 0};
    for (const Vec3<double>& x : {Vec3<double>{0.8, -1, 0.8}, Vec3<double>{-0.3, 0.2, -0.3}, Vec3<double>{0.02, -1, 0.3}}) {
        const auto paths = gi_irradiance(gi_cornell_quads(), gi_cornell_lamp(), x, n, 1, 16724, 8);
        const auto lattice = gi_irradiance_lattice(gi_cornell_quads(), gi_cornell_lamp(), x, n, 1, 4, 9);
        std::printf("paths %.6f +- %.6f, as many in four lattices %.6f +- %.6f\n", paths[1].mean, paths[1].standard_error,
                    lattice[1].mean, lattice[1].standard_error);
        // The error of four samples' mean is itself known within a factor 2 or 3.
        EXPECT_NEAR(lattice[1].mean, paths[1].mean, 4.5 * paths[1].standard_error + 9 * lattice[1].standard_error);
        EXPECT_LT(lattice[1].standard_error, 0.5 * paths[1].standard_error);
    }
}

TEST(GiRsm, LampsOfAFineMapAddUpToThePathTracersBounce) {
    // An empty room, so that nothing stands between: four walls and the floor's lamps onto a point of the ceiling.
    auto room = gi_cornell_quads();
    room.resize(5);
    const auto lamp = gi_cornell_lamp();
    const Vec3<double> x{0.4, 1, 0.3}, n{0, -1, 0};
    Vec3<double> sum{};
    const int size = 96;
    const double solid_angle = 2 * pi / size / size;
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            const Vec3<double> d = rsm_direction(i, j, size, lamp.axis);
            double t;
            const int met = gi_trace(room, lamp.position, d, 1e-4, 1e30, t);
            if (met < 0) continue;
            const auto& quad = room[static_cast<std::size_t>(met)];
            const Vec3<double> m = normalize(cross(quad.u, quad.v));
            const double area = t * t * solid_angle / max(-dot(m, d), 0.05);
            sum = sum + rsm_irradiance(x, n, lamp.position + d * t, m, lamp.intensity * quad.albedo * (solid_angle / pi), area);
        }
    const auto traced = gi_irradiance(room, lamp, x, n, 1, 60000, 4);
    std::printf("rsm %.6f traced %.6f +- %.6f\n", sum.x, traced[0].mean, traced[0].standard_error);
    // Besides noise: lamps beside the ceiling are kept at their texel's size, and the map's midpoint rule.
    EXPECT_NEAR(sum.x, traced[0].mean, 4.5 * traced[0].standard_error + 0.01 * traced[0].mean);
}

TEST(GiRsm, DiscOverAPlateIsItsFormFactor) {
    // pi r^2 / (d^2 + r^2) for a disc r = 0.5 at d = 2, radiance 1: NUMERICS 2.4's 0.184799568.
    const double area = pi * 0.25;
    const Vec3<double> e = rsm_disc_irradiance<double>({0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, -1}, splat3(area), area);
    EXPECT_NEAR(e.x, 0.184799568, 5e-10);
    EXPECT_NEAR(rsm_disc_irradiance<double>({0, 0, 0}, {0, 0, 1}, {0, 0, 1e-6}, {0, 0, -1}, splat3(area), area).x, pi, 1e-9);
    // Clamped at its own area the point lamp is bounded too.
    EXPECT_NEAR(rsm_irradiance<double>({0, 0, 0}, {0, 0, 1}, {0, 0, 1e-9}, {0, 0, -1}, splat3(area), area).x, 1, 1e-9);
    EXPECT_EQ(rsm_irradiance<double>({0, 0, 0}, {0, 0, 1}, {0, 0, 0}, {0, 0, -1}, splat3(area), area).x, 0);
}

TEST(GiRsm, TapsCountTheTexelsOfTheirDisc) {
    double sum = 0;
    const int n = 1000;
    for (int i = 0; i < n; ++i) sum += rsm_tap<double>({(i + 0.5) / n, 0.3}, 0.25, 64.0).z / n;
    EXPECT_NEAR(sum, pi * 16 * 16, 1e-6);
}

TEST(GiSampling, DirectionsAreUnitAndCosineWeighted) {
    for (const Vec3<double>& n : {Vec3<double>{0, 0, 1}, Vec3<double>{0, 0, -1}, normalize(Vec3<double>{1, -2, -0.5})}) {
        Vec3<double> t, b;
        gi_basis(n, t, b);
        EXPECT_NEAR(dot(t, b), 0, 1e-15);
        EXPECT_NEAR(dot(cross(t, b), n), 1, 1e-15);
        double sum = 0;
        for (int i = 0; i < 1024; ++i) {
            const auto d = gi_cosine_direction(gi_hammersley<double>(i, 1024, {0.1, 0.9}), n);
            EXPECT_NEAR(length(d), 1, 1e-14);
            sum += dot(d, n) / 1024;
        }
        EXPECT_NEAR(sum, 2.0 / 3, 1e-3);
    }
}

TEST(GiScreen, DistancePointAndMarchMeetAWall) {
    const double near = 0.1, far = 100;
    const Mat4<double> projection{
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, far / (near - far), -1}, {0, 0, near * far / (near - far), 0}}};
    EXPECT_NEAR(screen_distance(0.0, projection), near, 1e-15);
    EXPECT_NEAR(screen_distance(1.0, projection), far, 1e-9);
    // Half way over the screen between w = 1 and w = 3 is a quarter of the way in space.
    const Vec3<double> at = screen_point<double>({0, 0, 0, 1}, {3, 0, 0, 3}, 0.5);
    EXPECT_NEAR(at.z, 1.5, 1e-15);
    EXPECT_NEAR(at.x, 0.75, 1e-15);
    // A wall at distance 4 fills the screen; a ray from (0, 0, -1) slanting away meets it near x = 1.5.
    const double wall = (far / (far - near)) * (1 - near / 4);
    Vec2<double> hit;
    const auto depth = [&](const Vec2<double>&) { return wall; };
    const Vec3<double> direction = normalize(Vec3<double>{0.5, 0, -1});
    ASSERT_TRUE(screen_march<double>(depth, projection, {0, 0, -1}, direction, 10.0, 1.0, 0.0, hit, 256));
    EXPECT_NEAR(hit.x, 0.5 + 1.5 / 4 / 2, 2e-3);
    // Away from it: nothing, and the ray ends before the eye's plane.
    EXPECT_FALSE(screen_march<double>(depth, projection, {0, 0, -1}, -direction, 10.0, 1.0, 0.0, hit));
    EXPECT_NEAR(screen_clip<double>({0, 0, -1}, {0, 0, 1}, 10.0, 1e-3), 0.999, 1e-12);
}

TEST(GiCones, OpacityOfHalfAPathTwiceIsTheWhole) {
    for (const double a : {0.0, 1e-9, 1e-3, 0.3, 0.999}) {
        const double half = cone_opacity(a, 0.5);
        EXPECT_NEAR(1 - (1 - half) * (1 - half), a, 1e-15);
        EXPECT_NEAR(half, cone_opacity_textbook(a, 0.5), 1e-15);
    }
    EXPECT_EQ(cone_opacity(1.0, 0.5), 1);
    EXPECT_EQ(cone_opacity(1.0, 0.0), 0);
}

TEST(GiCones, UniformFogConvergesAndAFullVolumeIsItsRadiance) {
    const auto full = [](const Vec3<double>&, double) { return Vec4<double>{2, 2, 2, 1}; };
    EXPECT_NEAR(cone_gather<double>(full, {0.5, 0.5, 0.5}, {0, 0, 1}, 1.0 / 64, 1.0).x, 2 * pi, 1e-12);
    double weights = 0;
    for (int i = 0; i < 6; ++i) weights += cone_of_six<double>(i, {0, 1, 0}).w;
    EXPECT_NEAR(weights, 1, 1e-15);
    // Fog at one level: opacity a a voxel leaves (1 - a)^(length / voxel).
    const double a = 0.02, voxel = 1.0 / 64;
    const auto fog = [&](const Vec3<double>&, double) { return Vec4<double>{a, a, a, a}; };
    const auto seen = cone_march<double>(fog, {0, 0, 0}, {0, 0, 1}, 1e-6, voxel, 0.0, 30.5 * voxel);
    EXPECT_NEAR(seen.w, 1 - std::pow(1 - a, 30.5), 1e-12);
    EXPECT_NEAR(seen.x, seen.w, 1e-12);
}

TEST(GiSdf, DistancesAndTracesMeetSpheresAndBoxes) {
    EXPECT_NEAR(sdf_box<double>({2, 0, 0}, {1, 1, 1}), 1, 1e-15);
    EXPECT_NEAR(sdf_box<double>({0.2, 0, 0}, {1, 1, 1}), -0.8, 1e-15);
    EXPECT_NEAR(sdf_rectangle<double>({0.5, 2, 3}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}), std::sqrt(8.0), 1e-15);
    const auto sphere = [](const Vec3<double>& p) { return sdf_sphere(p, 1.0); };
    EXPECT_NEAR(sdf_trace<double>(sphere, {0, 0, 5}, {0, 0, -1}, 0.0, 10.0, 1e-9), 4, 1e-8);
    EXPECT_LT(sdf_trace<double>(sphere, {0, 1.5, 5}, {0, 0, -1}, 0.0, 10.0, 1e-6), 0);
}

TEST(GiSdf, ConePastAnEdgeIsTheShareOfADisc) {
    EXPECT_NEAR(sdf_open_share(0.0, 1.0, 0.1), 0.5, 1e-15);
    EXPECT_NEAR(sdf_open_share(0.1, 1.0, 0.1), 1, 1e-12);
    EXPECT_NEAR(sdf_open_share(-0.1, 1.0, 0.1), 0, 1e-12);
    // By area: u = 1/2.
    double area = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double x = -1 + 1.5 * (i + 0.5) / n;
        area += 2 * std::sqrt(1 - x * x) * 1.5 / n / pi;
    }
    EXPECT_NEAR(sdf_open_share_textbook(0.05, 1.0, 0.1), area, 1e-7);
    EXPECT_NEAR(sdf_open_share(0.05, 1.0, 0.1), sdf_open_share_textbook(0.05, 1.0, 0.1), 1e-14);
    // A half space y < 0 beside a ray along z at height 0.1: the cone grows into it, at t = 2 half an axis' width.
    const auto ground = [](const Vec3<double>& p) { return p.y; };
    const double open = sdf_visibility<double>(ground, {0, 0.1, 0}, {0, 0, 1}, 0.1, 0.0, 2.0, 1e-6);
    EXPECT_NEAR(open, sdf_open_share(0.1, 1.9, 0.1), 0.02);
    EXPECT_NEAR(sdf_soft_visibility<double>(ground, {0, 0.1, 0}, {0, 0, 1}, 10.0, 0.0, 2.0, 1e-6), 0.1 * 10 / 1.9, 0.02);
}

TEST(GiPath, VoxelsAndDistancesAreThoseOfTheRoom) {
    const auto room = gi_cornell_quads();
    EXPECT_NEAR(gi_distance(room, Vec3<double>{0, 0.5, 0}), std::hypot(0.1, 0.3), 1e-15);  // to the tall block's edge
    const Vec4<double> floor = gi_voxel(room, gi_cornell_lamp(), {0.8, -1, 0.8}, 1.0 / 16);
    EXPECT_EQ(floor.w, 1);
    const Vec3<double> direct = gi_direct(room, gi_cornell_lamp(), {0.8, -1, 0.8}, {0, 1, 0});
    EXPECT_NEAR(floor.x, 0.725 * direct.x / pi, 1e-3 * floor.x);
    EXPECT_EQ(gi_voxel(room, gi_cornell_lamp(), {0, 0.7, 0.5}, 1.0 / 16).w, 0);
}

}  // namespace
}  // namespace kiln::reference
