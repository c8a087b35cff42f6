#pragma once
// The lecture's printed shadow forms, as uber/lib/lecture_shadow.glsl names them. depth_map: callable uv -> depth.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T, class Depth>
T shadow_factor_lecture(const Depth& depth_map, const Vec4<T>& clip) {
    const Vec2<T> uv{clip.x / clip.w * T(0.5) + T(0.5), clip.y / clip.w * T(0.5) + T(0.5)};
    return depth_map(uv) < clip.z / clip.w * T(0.5) + T(0.5) ? T(0) : T(1);
}

template <class T, class Depth>
T shadow_factor_unbiased_lecture(const Depth& depth_map, const Vec4<T>& clip) {
    const Vec2<T> uv{clip.x / clip.w * T(0.5) + T(0.5), clip.y / clip.w * T(0.5) + T(0.5)};
    return depth_map(uv) < clip.z / clip.w ? T(0) : T(1);
}

// maps: callable (layer, uv, depth) -> 1 lit or 0; all `count` layers are sampled for the one that is kept.
template <class T, class Compare>
T cascaded_shadow_lecture(const Compare& maps, const Mat4<T> (&clip_of_world)[4], const Vec3<T>& receiver, int count, int index) {
    T lit[4] = {T(1), T(1), T(1), T(1)};
    for (int i = 0; i < count; ++i) {
        const Vec4<T> clip = clip_of_world[i] * Vec4<T>{receiver.x, receiver.y, receiver.z, T(1)};
        const Vec2<T> uv{clip.x / clip.w * T(0.5) + T(0.5), clip.y / clip.w * T(0.5) + T(0.5)};
        lit[i] = maps(i, uv, clip.z / clip.w);
    }
    return lit[index];
}

template <class T>
T pcss_penumbra_width_lecture(const T& receiver, const T& blocker, const T& size) {
    return (receiver - blocker) * size / blocker;
}
template <class T>
T pcss_mean_blocker_lecture(const T& sum, const T& count) {
    return sum / count;
}

template <class T>
Vec2<T> shadow_moments_lecture(const T& depth) {
    return {depth, depth * depth};
}
template <class T>
T moments_variance_lecture(const Vec2<T>& moments) {
    return moments.y - moments.x * moments.x;
}
template <class T>
T chebyshev_lecture(const Vec2<T>& moments, const T& t) {
    const T variance = moments_variance_lecture(moments);
    return variance / (variance + (t - moments.x) * (t - moments.x));
}

}  // namespace kiln::reference
