#pragma once
// Reflective shadow maps, as uber/lib/gi_rsm.glsl names them. Maps are callables (x, y) -> Vec4 or Vec3 of the texel.

#include "uber/reference/gi_sampling.h"

namespace kiln::reference {

template <class T>
Vec3<T> rsm_irradiance(const Vec3<T>& x, const Vec3<T>& n, const Vec3<T>& y, const Vec3<T>& m, const Vec3<T>& intensity,
                       const T& nearest) {
    const Vec3<T> d = y - x;
    const T square = dot(d, d);
    if (value(square) == 0) return splat3(T(0));
    const T cosines = max(dot(m, -d), T(0)) * max(dot(n, d), T(0)) / square;
    return intensity * (cosines / max(square, nearest));
}

template <class T>
Vec3<T> rsm_disc_irradiance(const Vec3<T>& x, const Vec3<T>& n, const Vec3<T>& y, const Vec3<T>& m, const Vec3<T>& intensity,
                            const T& area) {
    const Vec3<T> d = y - x;
    const T square = dot(d, d);
    if (value(square) == 0) return splat3(T(0));
    const T cosines = max(dot(m, -d), T(0)) * max(dot(n, d), T(0)) / square;
    return intensity * (cosines / (square + area / T(pi)));
}

template <class T>
Vec3<T> rsm_direction(int i, int j, int size, const Vec3<T>& axis) {
    Vec3<T> t, b;
    gi_basis(axis, t, b);
    const T z = (T(j) + T(0.5)) / T(size);
    const Vec2<T> p = cos_sin_of_turn((T(i) + T(0.5)) / T(size)) * -sqrt(T(1) - z * z);
    return t * p.x + b * p.y + axis * z;
}

template <class T, class P, class N, class I>
Vec3<T> rsm_gather_all(P positions, N normals, I intensities, const Vec3<T>& x, const Vec3<T>& n, int size = 16) {
    Vec3<T> sum = splat3(T(0));
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            const Vec4<T> y = positions(i, j);
            sum = sum + rsm_irradiance(x, n, y.xyz(), normals(i, j), intensities(i, j), y.w);
        }
    return sum;
}

template <class T>
Vec3<T> rsm_tap(const Vec2<T>& u, const T& reach, const T& size) {
    const T r = reach * u.x;
    const Vec2<T> p = cos_sin_of_turn(u.y) * -r;
    return {p.x, p.y, T(2 * pi) * r * reach * size * size};
}

}  // namespace kiln::reference
