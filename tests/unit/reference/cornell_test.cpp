// The Cornell-like box against closed forms: the interreflection furnace, form factors, an area light.

#include "uber/reference/cornell.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

using V = Vec3<double>;

CornellRoom empty_room() {
    CornellRoom room;
    room.block = false;
    room.light_radiance = splat3(0.0);
    for (V& albedo : room.albedo) albedo = splat3(0.0);
    return room;
}

// Emission 1 and albedo rho everywhere: (1 - rho^(n + 1)) / (1 - rho) after n bounces, whatever the geometry.
TEST(Cornell, InterreflectionFurnace) {
    for (const bool block : {false, true}) {
        CornellRoom room = empty_room();
        room.block = block;
        room.patches = 4;
        for (V& albedo : room.albedo) albedo = {0.5, 0.9, 0.0};
        for (V& emission : room.emission) emission = splat3(1.0);
        room.bounces = 10;
        const CornellBox box(room);
        for (size_t i = 0; i < box.patches_of_a_wall() * 6; ++i) {
            EXPECT_NEAR(box.radiosity()[i].x, 2.0 * (1.0 - std::pow(0.5, 11.0)), 1e-12);
            EXPECT_NEAR(box.radiosity()[i].y, 6.861894039, 1e-9);
            EXPECT_NEAR(box.radiosity()[i].z, 1.0, 1e-12);
        }
    }
}

// One white emitter and five black walls: what arrives at a wall is the form factor of unit squares.
TEST(Cornell, FormFactorsOfTheCube) {
    CornellRoom room = empty_room();
    room.emission[3] = splat3(1.0);
    room.bounces = 1;
    room.gather = 1024;
    room.patches = 8;
    for (int wall = 0; wall < 6; ++wall) {
        if (wall != 3) room.albedo[wall] = splat3(1.0);
    }
    const CornellBox box(room);
    for (size_t wall = 0; wall < 6; ++wall) {
        if (wall == 3) continue;
        double mean = 0;
        for (size_t i = 0; i < box.patches_of_a_wall(); ++i)
            mean += box.radiosity()[wall * box.patches_of_a_wall() + i].x / static_cast<double>(box.patches_of_a_wall());
        // 64 midpoints of patches and 1024 directions; near the common edge the integrand has a kink.
        EXPECT_NEAR(mean, wall == 2 ? 0.199824896 : 0.200043776, 2e-3) << wall;
    }
}

// A ceiling that is one light: E / L at the floor's middle is pi times the form factor of a centred unit square at distance 1.
TEST(Cornell, AreaLightHasItsClosedForm) {
    CornellRoom room = empty_room();
    room.light_radiance = splat3(1.0);
    room.light_low_x = room.light_low_z = 0.0;
    room.light_high_x = room.light_high_z = 1.0;
    room.light_steps = 32;
    room.patches = 2;
    const CornellBox box(room);
    double e = 0;
    const V up{0, 1, 0};
    box.light_at(V{0.5, 0.0, 0.5}, up, 16,
                 [&](const ArrivingLight& l) { e += l.radiance.x * l.solid_angle * dot(l.direction, up); });
    EXPECT_NEAR(e, 0.752274688, 2e-4);  // midpoints, 1024 cells
}

// The block's shadow: no light straight from the lamp behind it.
TEST(Cornell, BlockCastsAShadow) {
    CornellRoom room;
    room.patches = 4;
    room.gather = 16;
    room.bounces = 0;
    const CornellBox box(room);
    const auto direct = [&](double x, double z) {
        double e = 0;
        box.light_at(V{x, 0.0, z}, V{0, 1, 0}, 0,
                     [&](const ArrivingLight& l) { e += l.radiance.x * l.solid_angle * l.direction.y; });
        return e;
    };
    EXPECT_EQ(direct(0.85, 0.3), 0.0);
    EXPECT_GT(direct(0.2, 0.5), 0.5);
}

}  // namespace
}  // namespace kiln::reference
