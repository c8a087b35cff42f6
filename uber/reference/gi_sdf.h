#pragma once
// Distance fields, as uber/lib/gi_sdf.glsl names them. field: (position in the world) -> T, what sdf_distance gives.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T sdf_sphere(const Vec3<T>& p, const T& radius) {
    return length(p) - radius;
}
template <class T>
T sdf_box(const Vec3<T>& p, const Vec3<T>& half_size) {
    const Vec3<T> q = map(p, [](const T& x) { return abs(x); }) - half_size;
    return length(max(q, splat3(T(0)))) + min(max_component(q), T(0));
}
template <class T>
T sdf_rectangle(const Vec3<T>& p, const Vec3<T>& origin, const Vec3<T>& u, const Vec3<T>& v) {
    const Vec3<T> d = p - origin;
    return length(d - u * saturate(dot(d, u) / dot(u, u)) - v * saturate(dot(d, v) / dot(v, v)));
}

// The share of a unit disc on one side of a chord at u: the area by the angle.
inline double sdf_open_share_textbook(double d, double t, double tangent) {
    const double u = clamp(d / max(t * tangent, 1e-6), -1.0, 1.0);
    return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / pi;
}
template <class T>
T sdf_open_share(const T& d, const T& t, const T& tangent) {
    const T u = clamp(d / max(t * tangent, T(1e-6)), T(-1), T(1));
    const T c = sqrt((T(1) - u) * (T(1) + u));
    return T(0.5) + (u * c + atan(u, c)) / T(pi);
}
template <class T>
T sdf_soft_share(const T& d, const T& t, const T& k) {
    return saturate(k * d / max(t, T(1e-6)));
}

template <class T, class F>
T sdf_trace(F field, const Vec3<T>& origin, const Vec3<T>& direction, const T& start, const T& reach, const T& near,
            int steps = 64) {
    T t = start;
    for (int i = 0; i < steps && t < reach; ++i) {
        const T d = field(origin + direction * t);
        if (d < near) return t;
        t = t + d;
    }
    return T(-1);
}

// share: (distance, t) -> T.
template <class T, class F, class S>
T sdf_least_share(F field, S share, const Vec3<T>& origin, const Vec3<T>& direction, const T& start, const T& reach,
                  const T& near, int steps) {
    T open = T(1), t = start;
    for (int i = 0; i < steps && t < reach; ++i) {
        const T d = field(origin + direction * t);
        if (d < near) return T(0);
        open = min(open, share(d, t));
        t = t + d;
    }
    return open;
}
template <class T, class F>
T sdf_visibility(F field, const Vec3<T>& origin, const Vec3<T>& direction, const T& tangent, const T& start, const T& reach,
                 const T& near, int steps = 64) {
    const auto share = [&](const T& d, const T& t) { return sdf_open_share(d, t, tangent); };
    return sdf_least_share(field, share, origin, direction, start, reach, near, steps);
}
template <class T, class F>
T sdf_soft_visibility(F field, const Vec3<T>& origin, const Vec3<T>& direction, const T& k, const T& start, const T& reach,
                      const T& near, int steps = 64) {
    const auto share = [&](const T& d, const T& t) { return sdf_soft_share(d, t, k); };
    return sdf_least_share(field, share, origin, direction, start, reach, near, steps);
}

}  // namespace kiln::reference
