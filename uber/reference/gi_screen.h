#pragma once
// Rays against the depth buffer, as uber/lib/gi_screen.glsl names them. depth: (uv) -> T.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T screen_distance(const T& depth, const Mat4<T>& projection) {
    return projection.columns[3].z / (depth + projection.columns[2].z);
}

template <class T>
T screen_clip(const Vec3<T>& origin, const Vec3<T>& direction, const T& reach, const T& nearest) {
    const T end = -origin.z - direction.z * reach;
    return end < nearest ? (-origin.z - nearest) / direction.z : reach;
}

template <class T>
Vec3<T> screen_point(const Vec4<T>& start, const Vec4<T>& end, const T& t) {
    const T s = t * start.w / (t * start.w + (T(1) - t) * end.w);
    const Vec4<T> c{mix(start.x, end.x, s), mix(start.y, end.y, s), mix(start.z, end.z, s), mix(start.w, end.w, s)};
    return {c.x / c.w / T(2) + T(0.5), c.y / c.w / T(2) + T(0.5), c.w};
}

template <class T>
bool screen_meets(const T& ray_from, const T& ray_to, const T& surface, const T& thickness) {
    return max(ray_from, ray_to) >= surface && min(ray_from, ray_to) <= surface + thickness;
}

template <class T, class F>
bool screen_march(F depth, const Mat4<T>& projection, const Vec3<T>& origin, const Vec3<T>& direction, const T& reach,
                  const T& thickness, const T& jitter, Vec2<T>& hit, int steps = 32) {
    const T reached = screen_clip(origin, direction, reach, T(1e-3));
    const Vec3<T> to = origin + direction * reached;
    const Vec4<T> start = projection * Vec4<T>{origin.x, origin.y, origin.z, T(1)};
    const Vec4<T> end = projection * Vec4<T>{to.x, to.y, to.z, T(1)};
    T before = start.w;
    for (int i = 0; i < steps; ++i) {
        const Vec3<T> at = screen_point(start, end, (T(i + 1) - jitter) / T(steps));
        if (at.x < T(0) || at.y < T(0) || at.x > T(1) || at.y > T(1)) break;
        const T surface = screen_distance(depth(at.xy()), projection);
        if (at.z > surface && screen_meets(before, at.z, surface, thickness)) {
            hit = at.xy();
            return true;
        }
        before = at.z;
    }
    hit = {T(0), T(0)};
    return false;
}

}  // namespace kiln::reference
