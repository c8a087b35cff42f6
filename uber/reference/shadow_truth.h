#pragma once
// Ground truth of area shadows, double only: how much of a light a point sees, by cutting polygons exactly, by rays with a
// standard error, and in closed form for a straight edge; and the maps and moments of the same scenes, as a light at the
// centre would draw them, so that filters are tested on maps that are right.
//
// The light lies in the plane z = 0 about the origin and shines along +z; occluders are rectangles that face it. Visibility
// is the share of the light's area that is seen, what all filters of shadow maps estimate.

#include <cstdint>
#include <random>
#include <vector>

#include "uber/reference/vsm.h"

namespace kiln::reference {

// An edge parallel to a side of a square light: x is the receiver's distance from the middle of the penumbra towards the
// light, w the penumbra's width. Linear.
inline double square_light_edge(double x, double w) { return std::min(std::max(0.5 + x / w, 0.0), 1.0); }

// An edge under a round light, u = 2 x / w within [-1, 1]: the share of a disk on one side of a chord.
inline double disk_light_edge(double u) {
    const double c = std::min(std::max(u, -1.0), 1.0);
    return 0.5 + (c * std::sqrt(1 - c * c) + std::asin(c)) / pi;
}

// Width of the penumbra of an edge.
inline double edge_penumbra(double receiver, double blocker, double size) { return size * (receiver - blocker) / blocker; }

struct Rectangle {
    double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    double area() const { return std::max(x1 - x0, 0.0) * std::max(y1 - y0, 0.0); }
    bool holds(double x, double y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};
inline Rectangle intersection(const Rectangle& a, const Rectangle& b) {
    return {std::max(a.x0, b.x0), std::min(a.x1, b.x1), std::max(a.y0, b.y0), std::min(a.y1, b.y1)};
}

struct Occluder {
    Rectangle shape;
    double distance = 1;  // from the light's plane
};

struct ShadowScene {
    std::vector<Occluder> occluders;
    double receiver = 10;  // distance of the plane that receives
    double light = 1;      // side of the square, or diameter of the disk
    bool disk = false;
};

// An occluder as the receiver's point (x, y) sees it in the light's plane.
inline Rectangle shadow_on_light(const Occluder& o, double receiver, double x, double y) {
    const double k = receiver / (receiver - o.distance);  // from the receiver, the light's plane is k times as far
    return {x + (o.shape.x0 - x) * k, x + (o.shape.x1 - x) * k, y + (o.shape.y0 - y) * k, y + (o.shape.y1 - y) * k};
}

using Polygon = std::vector<Vec2<double>>;

// The part of a convex polygon where n . p <= d. Sutherland and Hodgman 1974.
inline Polygon clip_polygon(const Polygon& p, const Vec2<double>& n, double d) {
    Polygon out;
    for (size_t i = 0; i < p.size(); ++i) {
        const Vec2<double>&a = p[i], &b = p[(i + 1) % p.size()];
        const double da = dot(n, a) - d, db = dot(n, b) - d;
        if (da <= 0) out.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) out.push_back(a + (b - a) * (da / (da - db)));
    }
    return out;
}
inline double polygon_area(const Polygon& p) {
    double twice = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const Vec2<double>&a = p[i], &b = p[(i + 1) % p.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return std::fabs(twice) / 2;
}

// Area that is common to a convex light and a rectangle.
inline double covered_area(const Polygon& light, const Rectangle& r) {
    if (r.area() <= 0) return 0;
    Polygon p = clip_polygon(light, {-1, 0}, -r.x0);
    p = clip_polygon(p, {1, 0}, r.x1);
    p = clip_polygon(p, {0, -1}, -r.y0);
    return polygon_area(clip_polygon(p, {0, 1}, r.y1));
}

// A square as it is; a disk as a polygon of 4096 corners and the disk's area (it is off by less than 1e-6 of it anywhere).
inline Polygon light_polygon(const ShadowScene& scene) {
    const double h = scene.light / 2;
    if (!scene.disk) return {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
    Polygon p;
    constexpr int corners = 4096;
    const double step = 2 * pi / corners, r = h * std::sqrt(step / std::sin(step));
    for (int i = 0; i < corners; ++i) p.push_back({r * std::cos(i * step), r * std::sin(i * step)});
    return p;
}

// Visible share from the receiver's point (x, y): the light less the union of the occluders' shadows, by inclusion and
// exclusion over the sets that overlap. Exact; meant for few overlaps (two stacked occluders, a fence of disjoint slats).
inline double visible_share(const ShadowScene& scene, double x, double y) {
    const Polygon light = light_polygon(scene);
    std::vector<Rectangle> shadows;
    for (const Occluder& o : scene.occluders) {
        const Rectangle r = shadow_on_light(o, scene.receiver, x, y);
        if (covered_area(light, r) > 0) shadows.push_back(r);
    }
    // sum over non-empty sets S of (-1)^(|S| + 1) area(intersection of S), depth first; a set with no area has no supersets.
    struct Sum {
        const Polygon& light;
        const std::vector<Rectangle>& shadows;
        double from(size_t first, const Rectangle& common, double sign) const {
            double total = 0;
            for (size_t i = first; i < shadows.size(); ++i) {
                const Rectangle next = intersection(common, shadows[i]);
                const double area = covered_area(light, next);
                if (area > 0) total += sign * area + from(i + 1, next, -sign);
            }
            return total;
        }
    };
    const Rectangle all{-1e9, 1e9, -1e9, 1e9};
    return 1 - Sum{light, shadows}.from(0, all, 1) / polygon_area(light);
}

struct Estimate {
    double mean = 0, standard_error = 0;
};

// The same by n x n stratified rays. The standard error is that of independent rays, which stratified ones do not exceed.
inline Estimate visible_share_by_rays(const ShadowScene& scene, double x, double y, int n, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> within(0, 1);
    int seen = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double a = (i + within(random)) / n, b = (j + within(random)) / n;
            double lx = (a - 0.5) * scene.light, ly = (b - 0.5) * scene.light;
            if (scene.disk) {
                const double r = std::sqrt(a) * scene.light / 2;
                lx = r * std::cos(2 * pi * b), ly = r * std::sin(2 * pi * b);
            }
            bool clear = true;
            for (const Occluder& o : scene.occluders) {
                const double t = o.distance / scene.receiver;
                clear = clear && !o.shape.holds(lx + (x - lx) * t, ly + (y - ly) * t);
            }
            seen += clear ? 1 : 0;
        }
    const double count = static_cast<double>(n) * n, p = seen / count;
    return {p, std::sqrt(std::max(p * (1 - p), 1 / count) / count)};
}

// The perspective of a light at the origin: uv 0 to 1 covers [-extent / 2, extent / 2] metres at 1 m.
struct LightView {
    double near = 1, far = 20, extent = 2;
    double depth(double distance) const { return far * (distance - near) / (distance * (far - near)); }
    // Clip coordinates of a point; w is the distance from the light's plane.
    Vec4<double> clip(double x, double y, double z) const {
        return {2 * x / extent, 2 * y / extent, far * (z - near) / (far - near), z};
    }
};

// Distance from the light's plane of what the light's centre sees through uv: the nearest occluder or the receiver.
inline double nearest_distance(const ShadowScene& scene, const LightView& view, const Vec2<double>& uv) {
    const double x = (uv.x - 0.5) * view.extent, y = (uv.y - 0.5) * view.extent;  // at 1 m
    double nearest = scene.receiver;
    for (const Occluder& o : scene.occluders)
        if (o.distance < nearest && o.shape.holds(x * o.distance, y * o.distance)) nearest = o.distance;
    return nearest;
}

// Distances at the texels' centres, row after row, and the moments of them.
inline std::vector<double> distance_map(const ShadowScene& scene, const LightView& view, int size) {
    std::vector<double> texels;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) texels.push_back(nearest_distance(scene, view, {(x + 0.5) / size, (y + 0.5) / size}));
    return texels;
}
inline MomentMap moment_map(const std::vector<double>& distances, int size, double far, double reference) {
    MomentMap map{size, {}};
    for (const double d : distances) map.texels.push_back(shadow_moments(d, far, reference));
    return map;
}

// The scenes of the comparison: an edge, a square, a square with another under it, a fence.
inline ShadowScene edge_scene(double blocker) { return {{{{-100, 0, -100, 100}, blocker}}, 10, 1, false}; }
inline ShadowScene square_scene(double blocker) { return {{{{-1, 1, -1, 1}, blocker}}, 10, 1, false}; }
// The upper one is an edge, and a second far below it and near the receiver covers all of the light that the first leaves.
inline ShadowScene stacked_scene() { return {{{{-100, 0, -100, 100}, 3}, {{-100, 100, -100, 100}, 9}}, 10, 1, false}; }
inline ShadowScene fence_scene() {
    ShadowScene scene{{}, 10, 1, false};
    for (int i = -8; i < 8; ++i) scene.occluders.push_back({{i * 0.5, i * 0.5 + 0.25, -2, 2}, 6});
    return scene;
}

}  // namespace kiln::reference
