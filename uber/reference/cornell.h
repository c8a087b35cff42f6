#pragma once
// Ground truth for lightmaps: a box like Cornell's, lit through a rectangle in its ceiling, with one block on its floor. All
// double, deterministic: walls are patches of constant radiosity, and every gather uses the same directions, so that results
// are smooth along a surface and repeat exactly. What is baked for a point is the light that its directions and light points
// bring; the truth for any normal is the sum over the very same ones, so that a lightmap's error is the lightmap's alone.

#include <algorithm>
#include <vector>

#include "uber/reference/ibl_bake.h"
#include "uber/reference/sh.h"

namespace kiln::reference {

struct CornellRoom {
    // Walls -x +x -y +y -z +z of the unit cube (y up), then the block.
    Vec3<double> albedo[7] = {{0.63, 0.06, 0.05}, {0.14, 0.45, 0.09}, {0.73, 0.73, 0.73}, {0.73, 0.73, 0.73},
                              {0.73, 0.73, 0.73}, {0.73, 0.73, 0.73}, {0.73, 0.73, 0.73}};
    Vec3<double> emission[7]{};  // radiosity, W/m2, of whole surfaces
    Vec3<double> block_low{0.5, 0, 0.25}, block_high{0.8, 0.5, 0.6};
    bool block = true;
    Vec3<double> light_radiance{17.0, 12.0, 4.0};  // W/(m2 sr), downwards from y = 1
    double light_low_x = 0.35, light_high_x = 0.65, light_low_z = 0.35, light_high_z = 0.65;
    int patches = 12, gather = 256, light_steps = 12, bounces = 8;
};

// One piece of arriving light: radiance from a direction and the solid angle that it stands for.
struct ArrivingLight {
    Vec3<double> direction, radiance;
    double solid_angle = 0;
};

class CornellBox {
public:
    explicit CornellBox(const CornellRoom& room) : room_(room) { solve(); }

    // Calls f(ArrivingLight) for all light at a point of a surface with outward normal n, over the hemisphere of n.
    // `directions` for what comes from walls; emission of whole surfaces is among it.
    template <class F>
    void light_at(const Vec3<double>& point, const Vec3<double>& n, int directions, F f) const {
        const Vec3<double> from = point + n * 1e-6;
        const Mat3<double> frame = frame_around(n);
        for (int i = 0; i < directions; ++i) {
            const Vec2<double> u = hammersley(static_cast<uint32_t>(i), static_cast<uint32_t>(directions));
            const double z = (i + 0.5) / directions, r = std::sqrt(1.0 - z * z), phi = 2.0 * pi * u.y;
            const Vec3<double> d = frame * Vec3<double>{r * std::cos(phi), r * std::sin(phi), z};
            f(ArrivingLight{d, radiosity_[hit(from, d)] / pi, 2.0 * pi / directions});
        }
        lamp(from, n, [&](const ArrivingLight& l) { f(l); });
    }

    // Irradiance at a wall's patches, W/m2 (tests).
    const std::vector<Vec3<double>>& radiosity() const { return radiosity_; }
    size_t patches_of_a_wall() const { return static_cast<size_t>(room_.patches * room_.patches); }

private:
    static double get(const Vec3<double>& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
    static Vec3<double> put(int axis, double along, double a, double b) {
        return axis == 0 ? Vec3<double>{along, a, b} : axis == 1 ? Vec3<double>{a, along, b} : Vec3<double>{a, b, along};
    }
    size_t patch_of(int wall, double a, double b) const {
        const auto cell = [this](double t) { return std::clamp(static_cast<int>(t * room_.patches), 0, room_.patches - 1); };
        return static_cast<size_t>((wall * room_.patches + cell(b)) * room_.patches + cell(a));
    }

    // Distance to the block along d, its face in `face` (as walls); infinity when it is missed.
    double block_distance(const Vec3<double>& from, const Vec3<double>& d, int& face) const {
        double enter = 0, leave = 1e30;
        face = -1;
        for (int axis = 0; axis < 3; ++axis) {
            const double o = get(from, axis), v = get(d, axis), low = get(room_.block_low, axis),
                         high = get(room_.block_high, axis);
            if (v == 0.0) {
                if (o < low || o > high) return 1e30;
                continue;
            }
            const double near = ((v > 0.0 ? low : high) - o) / v, far = ((v > 0.0 ? high : low) - o) / v;
            if (near > enter) enter = near, face = 2 * axis + (v > 0.0 ? 0 : 1);
            leave = std::min(leave, far);
        }
        return face < 0 || enter > leave ? 1e30 : enter;
    }

    // The patch that a ray meets.
    size_t hit(const Vec3<double>& from, const Vec3<double>& d) const {
        double nearest = 1e30;
        int wall = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double v = get(d, axis);
            if (v == 0.0) continue;
            const double t = ((v > 0.0 ? 1.0 : 0.0) - get(from, axis)) / v;
            if (t < nearest) nearest = t, wall = 2 * axis + (v > 0.0 ? 1 : 0);
        }
        int face = -1;
        if (room_.block) {
            const double t = block_distance(from, d, face);
            if (t < nearest) return on_block(from + d * t, face);
        }
        const Vec3<double> p = from + d * nearest;
        return wall < 2 ? patch_of(wall, p.y, p.z) : wall < 4 ? patch_of(wall, p.x, p.z) : patch_of(wall, p.x, p.y);
    }
    size_t on_block(const Vec3<double>& p, int face) const {
        const Vec3<double> t = (p - room_.block_low) / (room_.block_high - room_.block_low);
        const int axis = face / 2;
        return axis == 0 ? patch_of(6 + face, t.y, t.z) : axis == 1 ? patch_of(6 + face, t.x, t.z) : patch_of(6 + face, t.x, t.y);
    }

    // Light straight from the lamp: midpoints of its cells, each with its solid angle, where nothing stands between.
    template <class F>
    void lamp(const Vec3<double>& from, const Vec3<double>& n, F f) const {
        const double dx = (room_.light_high_x - room_.light_low_x) / room_.light_steps;
        const double dz = (room_.light_high_z - room_.light_low_z) / room_.light_steps;
        for (int i = 0; i < room_.light_steps; ++i) {
            for (int j = 0; j < room_.light_steps; ++j) {
                const Vec3<double> q{room_.light_low_x + (i + 0.5) * dx, 1.0, room_.light_low_z + (j + 0.5) * dz};
                const Vec3<double> to = q - from;
                const double square = dot(to, to), distance = std::sqrt(square);
                const Vec3<double> d = to / distance;
                if (dot(d, n) <= 0.0 || d.y <= 0.0) continue;
                int face = -1;
                if (room_.block && block_distance(from, d, face) < distance) continue;
                f(ArrivingLight{d, room_.light_radiance, d.y * dx * dz / square});
            }
        }
    }

    void solve() {
        const int n = room_.patches;
        const size_t count = static_cast<size_t>(12 * n * n);
        const auto rays = static_cast<uint32_t>(room_.gather);
        std::vector<Vec3<double>> start(count);
        std::vector<size_t> seen(count * rays);
        for (int wall = 0; wall < (room_.block ? 12 : 6); ++wall) {
            const int axis = wall % 6 / 2, side = wall & 1;
            const bool block = wall >= 6;
            for (int b = 0; b < n; ++b) {
                for (int a = 0; a < n; ++a) {
                    const size_t patch = patch_of(wall, (a + 0.5) / n, (b + 0.5) / n);
                    Vec3<double> p = put(axis, side, (a + 0.5) / n, (b + 0.5) / n);
                    Vec3<double> normal = put(axis, side ? -1.0 : 1.0, 0.0, 0.0);
                    if (block) {
                        p = room_.block_low + p * (room_.block_high - room_.block_low);
                        normal = -normal;
                    }
                    const Mat3<double> frame = frame_around(normal);
                    const Vec3<double> from = p + normal * 1e-6;
                    for (uint32_t i = 0; i < rays; ++i)
                        seen[patch * rays + i] = hit(from, frame * sample_cosine(hammersley(i, rays)));
                    Vec3<double> direct{};
                    lamp(from, normal, [&](const ArrivingLight& l) {
                        direct = direct + l.radiance * (l.solid_angle * dot(l.direction, normal));
                    });
                    const int surface = block ? 6 : wall;
                    start[patch] = room_.emission[surface] + room_.albedo[surface] * direct;
                }
            }
        }
        radiosity_ = start;
        for (int bounce = 0; bounce < room_.bounces; ++bounce) {
            std::vector<Vec3<double>> next = start;
            for (size_t patch = 0; patch < count; ++patch) {
                Vec3<double> sum{};
                for (uint32_t i = 0; i < rays; ++i) sum = sum + radiosity_[seen[patch * rays + i]];
                const size_t wall = patch / static_cast<size_t>(n * n);
                next[patch] = next[patch] + room_.albedo[wall < 6 ? wall : 6] * sum / static_cast<double>(rays);
            }
            radiosity_ = std::move(next);
        }
    }

    CornellRoom room_;
    std::vector<Vec3<double>> radiosity_;  // W/m2, by patch
};

}  // namespace kiln::reference
