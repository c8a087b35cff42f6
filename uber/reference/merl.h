#pragma once
// Look-up in a MERL table, as uber/lib/merl.glsl names it.

#include <array>

#include "uber/reference/numbers.h"

namespace kiln::reference {

inline constexpr int merl_theta_h_bins = 90, merl_theta_d_bins = 90, merl_phi_d_bins = 180;
inline constexpr int merl_plane = merl_theta_h_bins * merl_theta_d_bins * merl_phi_d_bins;

template <class T>
T angle_of(const T& y, const T& x) {
    return value(y) == 0 && value(x) == 0 ? T(0) : atan(y, x);
}

// theta_h and theta_d in [0, 90], phi_d in [0, 180). n, l, h: unit vectors.
template <class T>
Vec3<T> merl_coordinates(const Vec3<T>& n, const Vec3<T>& l, const Vec3<T>& h) {
    const Vec3<T> across = cross(n, h), aside = cross(l, h);
    const T n_dot_h = dot(n, h), l_dot_h = dot(l, h);
    const T theta_h = angle_of(length(across), n_dot_h), theta_d = angle_of(length(aside), l_dot_h);
    T phi_d = angle_of(dot(l, across), l_dot_h * n_dot_h - dot(n, l));
    if (phi_d < T(0)) phi_d = phi_d + T(pi);
    if (phi_d >= T(pi)) phi_d = T(0);
    return {T(90) * sqrt(saturate(theta_h / T(0.5 * pi))), T(90) * saturate(theta_d / T(0.5 * pi)), T(180) * phi_d / T(pi)};
}

inline int merl_index(const std::array<int, 3>& bin) { return bin[2] + merl_phi_d_bins * (bin[1] + merl_theta_d_bins * bin[0]); }

inline std::array<int, 3> merl_bin(const Vec3<double>& c) {
    const auto inside = [](double x, int bins) { return std::min(std::max(static_cast<int>(x), 0), bins - 1); };
    return {inside(c.x, merl_theta_h_bins), inside(c.y, merl_theta_d_bins), inside(c.z, merl_phi_d_bins)};
}

struct MerlCorners {
    std::array<int, 3> low, high;
    Vec3<double> weight;
};
inline MerlCorners merl_corners(const Vec3<double>& c) {
    const Vec3<double> shifted = c - 0.5, whole = map(shifted, [](double x) { return std::floor(x); });
    const int x = static_cast<int>(whole.x), y = static_cast<int>(whole.y), z = static_cast<int>(whole.z);
    const auto held = [](int i) { return std::min(std::max(i, 0), 89); };
    const auto round = [](int i) { return (i % merl_phi_d_bins + merl_phi_d_bins) % merl_phi_d_bins; };
    return {{held(x), held(y), round(z)}, {held(x + 1), held(y + 1), round(z + 1)}, shifted - whole};
}

// The value between bin centres. table(index): one plane.
template <class Table>
double merl_interpolated(const Vec3<double>& c, Table table) {
    const MerlCorners m = merl_corners(c);
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const bool x = i & 1, y = i & 2, z = i & 4;
        const double weight =
            (x ? m.weight.x : 1 - m.weight.x) * (y ? m.weight.y : 1 - m.weight.y) * (z ? m.weight.z : 1 - m.weight.z);
        sum += weight * table(merl_index({(x ? m.high : m.low)[0], (y ? m.high : m.low)[1], (z ? m.high : m.low)[2]}));
    }
    return sum;
}

template <class T>
Vec3<T> merl_reflectance(const Vec3<T>& stored) {
    return max(stored, splat3(T(0))) * Vec3<T>{T(1.0 / 1500), T(1.15 / 1500), T(1.66 / 1500)};
}

// rgb over a. 0 where nothing was measured.
template <class T>
Vec3<T> merl_measured(const Vec4<T>& sum) {
    return sum.xyz() / max(sum.w, T(1e-6));
}

// table: (theta_h, theta_d, phi_d) -> Vec4<T>: BRDF and 1, or 0.
template <class T, class Table>
Vec3<T> merl_lookup_nearest(const Table& table, const Vec3<T>& c) {
    const std::array<int, 3> bin = merl_bin({value(c.x), value(c.y), value(c.z)});
    return merl_measured(table(bin[0], bin[1], bin[2]));
}

template <class T, class Table>
Vec3<T> merl_lookup(const Table& table, const Vec3<T>& c) {
    const MerlCorners m = merl_corners({value(c.x), value(c.y), value(c.z)});
    // No decision that could be close: on a centre either pair of corners gives the same.
    const auto weight = [](const T& x, double w) { return x - T(0.5) - T(std::round(value(x) - 0.5 - w)); };
    const Vec3<T> w{weight(c.x, m.weight.x), weight(c.y, m.weight.y), weight(c.z, m.weight.z)};
    const auto mixed = [](const Vec4<T>& a, const Vec4<T>& b, const T& t) {
        return Vec4<T>{mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t), mix(a.w, b.w, t)};
    };
    const auto plane = [&](int h) {
        return mixed(mixed(table(h, m.low[1], m.low[2]), table(h, m.low[1], m.high[2]), w.z),
                     mixed(table(h, m.high[1], m.low[2]), table(h, m.high[1], m.high[2]), w.z), w.y);
    };
    return merl_measured(mixed(plane(m.low[0]), plane(m.high[0]), w.x));
}

// Light and view of given coordinates, for filling a table: n is the z axis, h in the plane of x and z.
struct MerlDirections {
    Vec3<double> l, v, h;
};
inline MerlDirections merl_directions(const Vec3<double>& c) {
    const double theta_h = 0.5 * pi * (c.x / 90) * (c.x / 90), theta_d = 0.5 * pi * c.y / 90, phi_d = pi * c.z / 180;
    const Vec3<double> h{std::sin(theta_h), 0, std::cos(theta_h)};
    const Vec3<double> d{std::sin(theta_d) * std::cos(phi_d), std::sin(theta_d) * std::sin(phi_d), std::cos(theta_d)};
    const Vec3<double> l{h.z * d.x + h.x * d.z, d.y, h.z * d.z - h.x * d.x};
    return {l, h * (2 * dot(l, h)) - l, h};
}

}  // namespace kiln::reference
