#pragma once
// A receiver in a shadow map and how its surface rises, as uber/lib/shadow_receiver.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// xyz: uv and depth; w: 1 inside the map, else 0 with (1/2, 1/2, 0).
template <class T>
Vec4<T> shadow_coordinates(const Vec4<T>& clip) {
    const Vec4<T> nowhere{T(0.5), T(0.5), T(0), T(0)};
    if (!(clip.w > T(0))) return nowhere;
    const Vec3<T> place{(clip.x / clip.w + T(1)) / T(2), (clip.y / clip.w + T(1)) / T(2), clip.z / clip.w};
    for (const T& x : {place.x, place.y, place.z})
        if (!(x >= T(0) && x <= T(1))) return nowhere;
    return {place.x, place.y, place.z, T(1)};
}

// d depth / d uv of the plane p.x x + p.y y + p.z z + p.w = 0 of NDC; uv runs half as fast as NDC.
template <class T>
Vec2<T> receiver_depth_slope(const Vec4<T>& plane, const T& limit) {
    const T rise = abs(plane.z) > T(1e-30) ? plane.z : T(1e-30);
    return map(plane.xy(), [&](const T& p) { return clamp(T(-2) * p / rise, -limit, limit); });
}

// The gradient of depth over uv from two steps (du, dv, ddepth), by Cramer's rule; 0 for parallel steps.
template <class T>
Vec2<T> receiver_depth_slope(const Vec3<T>& dx, const Vec3<T>& dy, const T& limit) {
    const T det = dx.x * dy.y - dx.y * dy.x;
    if (!(abs(det) > T(1e-6) * (abs(dx.x * dy.y) + abs(dx.y * dy.x)))) return {T(0), T(0)};
    return {clamp((dx.z * dy.y - dx.y * dy.z) / det, -limit, limit), clamp((dx.x * dy.z - dx.z * dy.x) / det, -limit, limit)};
}

template <class T>
T receiver_depth_bias(const Vec2<T>& slope, const Vec2<T>& reach, const T& quantum) {
    return abs(slope.x) * reach.x + abs(slope.y) * reach.y + T(2) * quantum;
}

}  // namespace kiln::reference
