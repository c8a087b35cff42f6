#pragma once
// Probes as uber/lib/probes.glsl names them.

#include <array>

#include "uber/reference/sh.h"

namespace kiln::reference {

// Corner i has bits x, y, z.
template <class T>
std::array<T, 8> trilinear_weights(const Vec3<T>& t) {
    const Vec3<T> b = saturate(t);
    std::array<T, 8> w;
    for (unsigned i = 0; i < 8; ++i) w[i] = (i & 1 ? b.x : T(1) - b.x) * (i & 2 ? b.y : T(1) - b.y) * (i & 4 ? b.z : T(1) - b.z);
    return w;
}

struct GridCell {
    int cell[3];
    double t[3];
};
inline GridCell probe_grid_cell(const Vec3<double>& from_first, const Vec3<double>& inverse_spacing, const int (&count)[3]) {
    GridCell out{};
    const Vec3<double> scaled = from_first * inverse_spacing;
    const double g[3] = {scaled.x, scaled.y, scaled.z};
    for (int i = 0; i < 3; ++i) {
        const double inside = std::clamp(g[i], 0.0, count[i] - 1.0);
        out.cell[i] = std::max(0, std::min(static_cast<int>(inside), count[i] - 2));
        out.t[i] = inside - out.cell[i];
    }
    return out;
}

template <class T>
T probe_facing_weight(const Vec3<T>& to_probe, const Vec3<T>& n) {
    const T wrapped = (dot(to_probe, n) + T(1)) / T(2);
    return wrapped * wrapped + T(0.2);
}

template <class T>
Vec4<T> normalize_weights(const Vec4<T>& weights) {
    const Vec4<T> w = map(weights, [](const T& x) { return max(x, T(0)); });
    const T largest = max(max(w.x, w.y), max(w.z, w.w));
    if (!(value(largest) > 1e-30)) return {T(0.25), T(0.25), T(0.25), T(0.25)};
    const Vec4<T> scaled = w / largest;
    return scaled / (scaled.x + scaled.y + scaled.z + scaled.w);
}

// Barycentric coordinates from cofactors; by inverse squares when the volume is below 1e-5 of the longest edge's cube.
template <class T>
Vec4<T> tetrahedron_weights(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, const Vec3<T>& d) {
    const Vec3<T> ab = b - a, ac = c - a, ad = d - a, ap = p - a;
    const Vec3<T> n_b = cross(ac, ad);
    const T volume = dot(ab, n_b), size = sqrt(max(dot(ab, ab), max(dot(ac, ac), dot(ad, ad))));
    if (!(abs(volume) > T(1e-5) * size * size * size)) {
        const auto near = [&](const Vec3<T>& q) { return T(1) / (dot(p - q, p - q) + (T(1e-6) * size * size + T(1e-20))); };
        return normalize_weights(Vec4<T>{near(a), near(b), near(c), near(d)});
    }
    const T w_b = dot(ap, n_b) / volume, w_c = dot(ap, cross(ad, ab)) / volume, w_d = dot(ap, cross(ab, ac)) / volume;
    return {T(1) - w_b - w_c - w_d, w_b, w_c, w_d};
}
// The textbook form, for a tetrahedron that is not flat: volumes of the four tetrahedra that p makes with the faces.
inline Vec4<double> tetrahedron_weights_textbook(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b,
                                                 const Vec3<double>& c, const Vec3<double>& d) {
    const auto volume = [](const Vec3<double>& o, const Vec3<double>& x, const Vec3<double>& y, const Vec3<double>& z) {
        return dot(x - o, cross(y - o, z - o));
    };
    return Vec4<double>{volume(p, b, c, d), volume(a, p, c, d), volume(a, b, p, d), volume(a, b, c, p)} / volume(a, b, c, d);
}

template <class T>
ShL1<T> sh_add(ShL1<T> sum, const ShL1<T>& sh, const T& weight) {
    for (size_t i = 0; i < 4; ++i) sum.c[i] = sum.c[i] + sh.c[i] * weight;
    return sum;
}
template <class T>
ShL2<T> sh_add(ShL2<T> sum, const ShL2<T>& sh, const T& weight) {
    for (size_t i = 0; i < 9; ++i) sum.c[i] = sum.c[i] + sh.c[i] * weight;
    return sum;
}
template <class T>
ShMomentsL1<T> sh_add(const ShMomentsL1<T>& sum, const ShMomentsL1<T>& sh, const T& weight) {
    return {sum.m0 + sh.m0 * weight, sum.m1_y + sh.m1_y * weight, sum.m1_z + sh.m1_z * weight, sum.m1_x + sh.m1_x * weight};
}

// Where the ray leaves the box, by slabs: the nearest of three walls ahead. One that it runs along is 1e20 away.
template <class T>
Vec3<T> box_projected_direction(const Vec3<T>& position, const Vec3<T>& direction, const Vec3<T>& box_min, const Vec3<T>& box_max,
                                const Vec3<T>& probe) {
    const auto slab = [](const T& p, const T& d, const T& low, const T& high) {
        return max(value(d) < 0.0 ? p - low : high - p, T(0)) / max(abs(d), T(1e-20));
    };
    const T t = min(min(slab(position.x, direction.x, box_min.x, box_max.x), slab(position.y, direction.y, box_min.y, box_max.y)),
                    slab(position.z, direction.z, box_min.z, box_max.z));
    return position + direction * t - probe;
}

template <class T>
T probe_box_weight(const Vec3<T>& position, const Vec3<T>& box_min, const Vec3<T>& box_max, const T& fade) {
    const Vec3<T> inside = min(position - box_min, box_max - position);
    return saturate(min(min(inside.x, inside.y), inside.z) / max(fade, T(1e-6)));
}

template <class T>
Vec3<T> probe_normalized_reflection(const Vec3<T>& reflection, const Vec3<T>& irradiance_here, const Vec3<T>& irradiance_at_probe,
                                    const T& limit) {
    const Vec3<T> luminance{T(0.2126), T(0.7152), T(0.0722)};
    const T here = max(dot(irradiance_here, luminance), T(0)), there = max(dot(irradiance_at_probe, luminance), T(0));
    if (!(value(there) > 1e-20)) return reflection;
    return reflection * min(here / there, limit);
}

}  // namespace kiln::reference
