#pragma once
// Cones through a volume, as uber/lib/gi_cones.glsl names them. volume: (position, level) -> Vec4.

#include "uber/reference/gi_sampling.h"

namespace kiln::reference {

template <class T>
T cone_level(const T& t, const T& tangent, const T& voxel) {
    return log2(max(T(2) * t * tangent / voxel, T(1)));
}

inline double cone_opacity_textbook(double alpha, double ratio) {
    if (alpha >= 1) return ratio > 0 ? 1 : 0;
    return -std::expm1(ratio * std::log1p(-alpha));
}
template <class T>
T cone_opacity(const T& alpha, const T& ratio) {
    if (alpha >= T(1)) return T(ratio > T(0) ? 1 : 0);
    if (alpha < T(1e-3)) return ratio * alpha * (T(1) - (ratio - T(1)) * alpha * (T(0.5) - (ratio - T(2)) * alpha / T(6)));
    return T(1) - exp2(ratio * log2(T(1) - alpha));
}

template <class T>
Vec4<T> cone_over(const Vec4<T>& gathered, const Vec4<T>& behind) {
    return gathered + behind * (T(1) - gathered.w);
}

template <class T, class F>
Vec4<T> cone_march(F volume, const Vec3<T>& origin, const Vec3<T>& direction, const T& tangent, const T& voxel, const T& start,
                   const T& reach, int steps = 64) {
    Vec4<T> gathered{};
    T t = start;
    for (int i = 0; i < steps && t < reach && gathered.w < T(0.99); ++i) {
        const T level = cone_level(t, tangent, voxel);
        const Vec4<T> here = volume(origin + direction * t, level);
        const T opacity = cone_opacity(min(here.w, T(1)), T(0.5));
        const Vec3<T> colour = here.w > T(0) ? here.xyz() * (opacity / here.w) : splat3(T(0));
        gathered = cone_over(gathered, Vec4<T>{colour.x, colour.y, colour.z, opacity});
        t = t + voxel * exp2(level) / T(2);
    }
    return gathered;
}

template <class T>
Vec4<T> cone_of_six(int i, const Vec3<T>& n) {
    if (i == 0) return {n.x, n.y, n.z, T(0.25)};
    Vec3<T> t, b;
    gi_basis(n, t, b);
    const T phi = T(2 * pi * (i > 2 ? i - 5 : i) / 5);
    const Vec3<T> d = (t * cos(phi) + b * sin(phi)) * T(std::sqrt(0.75)) + n * T(0.5);
    return {d.x, d.y, d.z, T(0.15)};
}

template <class T, class F>
Vec4<T> cone_gather(F volume, const Vec3<T>& position, const Vec3<T>& n, const T& voxel, const T& reach) {
    Vec4<T> sum{};
    for (int i = 0; i < 6; ++i) {
        const Vec4<T> cone = cone_of_six(i, n);
        sum = sum + cone_march(volume, position + n * voxel, cone.xyz(), T(1 / std::sqrt(3.0)), voxel, voxel, reach) * cone.w;
    }
    return {sum.x * T(pi), sum.y * T(pi), sum.z * T(pi), sum.w};
}

}  // namespace kiln::reference
