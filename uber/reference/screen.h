#pragma once
// From the screen back into the world, as uber/lib/screen.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> screen_to_world(const Mat4<T>& world_of_clip, const Vec2<T>& uv, const T& depth) {
    const Vec4<T> p = world_of_clip * Vec4<T>{uv.x * T(2) - T(1), uv.y * T(2) - T(1), depth, T(1)};
    return Vec3<T>{p.x, p.y, p.z} / (abs(p.w) > T(1e-20) ? p.w : T(1e-20));
}

template <class T>
Vec3<T> screen_ray(const Mat4<T>& world_of_clip, const Vec2<T>& uv) {
    const Vec2<T> ndc{uv.x * T(2) - T(1), uv.y * T(2) - T(1)};
    const Vec4<T> near = world_of_clip * Vec4<T>{ndc.x, ndc.y, T(0), T(1)};
    const Vec4<T> far = world_of_clip * Vec4<T>{ndc.x, ndc.y, T(1), T(1)};
    return Vec3<T>{far.x * near.w - near.x * far.w, far.y * near.w - near.y * far.w, far.z * near.w - near.z * far.w};
}

}  // namespace kiln::reference
