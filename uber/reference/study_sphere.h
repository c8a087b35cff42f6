#pragma once
// The sphere of the study shaders, as uber/study_sphere.glsl has it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec2<T> sphere_place(const Vec2<T>& uv) {
    return {(uv.x * T(2) - T(1)) * T(1.05), (uv.y * T(2) - T(1)) * T(-1.05)};
}

template <class T>
bool on_sphere(const Vec2<T>& uv) {
    const Vec2<T> p = sphere_place(uv);
    return dot(p, p) < T(1);
}

template <class T>
Vec3<T> sphere_normal(const Vec2<T>& uv) {
    const Vec2<T> p = sphere_place(uv);
    const T z2 = T(1) - dot(p, p);
    if (z2 > T(0)) return {p.x, p.y, sqrt(z2)};
    const T scale = inversesqrt(dot(p, p));
    return {p.x * scale, p.y * scale, T(0)};
}

template <class T>
Vec3<T> sphere_viewer() {
    return {T(0), T(0), T(1)};
}

}  // namespace kiln::reference
