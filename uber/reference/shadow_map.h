#pragma once
// Hard shadows from a depth map, as uber/lib/shadow_map.glsl names them. Maps are callables: map(uv, reference) and
// cube(direction, reference) give the share of the look-up's texels whose depth is not below the reference.
// Williams 1978; Reeves et al. 1987.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// position + n 3/2 texel sin(a), where n_dot_axis is cos(a), a between n and the map's axis.
template <class T>
Vec3<T> offset_shadow_receiver(const Vec3<T>& position, const Vec3<T>& n, const T& n_dot_axis, const T& texel) {
    return position + n * (T(1.5) * texel * sqrt(saturate(T(1) - n_dot_axis * n_dot_axis)));
}

template <class T>
T perspective_axis_cosine(const Mat4<T>& clip_of_world, const Vec3<T>& n) {
    const auto& c = clip_of_world.columns;
    return dot(n, Vec3<T>{c[0].w, c[1].w, c[2].w});
}

// The least of |n|'s components along the axes of the faces within reach.
template <class T>
T cube_axis_cosine(const Vec3<T>& from_light, const Vec3<T>& n, const T& texel) {
    const auto size = [](const T& x) { return abs(x); };
    const Vec3<T> a = map(from_light, size), along = map(n, size);
    const T reached = max_component(a) * (T(1) - T(4) * texel);
    T least(1);
    if (a.x >= reached) least = min(least, along.x);
    if (a.y >= reached) least = min(least, along.y);
    if (a.z >= reached) least = min(least, along.z);
    return least;
}

template <class T, class Map>
T shadow_factor_2d(const Map& map, const Vec4<T>& clip, const T& bias) {
    if (!(clip.w > T(0))) return T(1);
    const Vec3<T> ndc = clip.xyz() / clip.w;
    const Vec2<T> uv = ndc.xy() * T(0.5) + Vec2<T>{T(0.5), T(0.5)};
    for (const T& x : {uv.x, uv.y, ndc.z})
        if (x < T(0) || x > T(1)) return T(1);
    return map(uv, ndc.z - bias);
}

// Depth of a perspective face: far / (far - near) - far near / ((far - near) z).
template <class T, class Cube>
T shadow_factor_cube(const Cube& cube, const Vec3<T>& from_light, const T& near, const T& far, const T& bias) {
    const T z = max(max(abs(from_light.x), abs(from_light.y)), abs(from_light.z));
    if (z < near || z > far) return T(1);
    const T scale = far / max(far - near, T(1e-6));
    const T depth = scale - scale * near / max(z, T(1e-6));
    return cube(from_light, depth - bias);
}

}  // namespace kiln::reference
