#pragma once
// Image-based light when shading, as uber/lib/ibl.glsl names it. A split-sum table is a callable from uv to (A, B).

#include "uber/reference/fresnel.h"

namespace kiln::reference {

template <class T>
Vec2<T> split_sum_uv(const T& n_dot_v, const T& roughness, const T& size) {
    return {(saturate(n_dot_v) * (size - T(1)) + T(0.5)) / size, (saturate(roughness) * (size - T(1)) + T(0.5)) / size};
}
inline Vec2<double> split_sum_texel(int x, int y, int size) { return {x / (size - 1.0), y / (size - 1.0)}; }

template <class Table, class T>
Vec2<T> split_sum_lookup(const Table& table, const T& n_dot_v, const T& roughness, const T& size) {
    return table(split_sum_uv(n_dot_v, roughness, size));
}

// Karis 2014, "Physically Based Shading on Mobile".
template <class T>
Vec2<T> split_sum_fit(const T& n_dot_v, const T& roughness) {
    const T r = saturate(roughness);
    const T rx = r * T(-1) + T(1), ry = r * T(-0.0275) + T(0.0425), rz = r * T(-0.572) + T(1.04), rw = r * T(0.022) + T(-0.04);
    const T a004 = min(rx * rx, exp2(T(-9.28) * saturate(n_dot_v))) * rx + ry;
    return {saturate(T(-1.04) * a004 + rz), saturate(T(1.04) * a004 + rw)};
}

template <class T>
Vec3<T> environment_specular(const Vec3<T>& prefiltered, const Vec3<T>& f0, const Vec2<T>& ab) {
    return prefiltered * (f0 * ab.x + splat3(fresnel_f90(f0) * ab.y));
}
template <class T>
Vec3<T> environment_specular_multiscatter(const Vec3<T>& prefiltered, const Vec3<T>& f0, const Vec2<T>& ab) {
    const T e = clamp(ab.x + ab.y, T(1e-3), T(1));
    return environment_specular(prefiltered, f0, ab) * (splat3(T(1)) + f0 * (T(1) / e - T(1)));
}

// Fdez-Aguera 2019, its geometric series in closed form.
template <class T>
Vec3<T> image_based_light(const Vec3<T>& diffuse, const Vec3<T>& f0, const Vec3<T>& irradiance_over_pi,
                          const Vec3<T>& prefiltered, const Vec2<T>& ab) {
    const Vec3<T> single = environment_specular(splat3(T(1)), f0, ab), average = fresnel_average(f0);
    const T lost = saturate(T(1) - ab.x - ab.y);
    const Vec3<T> multiple = single * average * lost / max(splat3(T(1)) - average * lost, splat3(T(1e-3)));
    const Vec3<T> below = diffuse * max(splat3(T(1)) - single - multiple, splat3(T(0)));
    return single * prefiltered + (multiple + below) * irradiance_over_pi;
}

}  // namespace kiln::reference
