#pragma once
// Normal maps and tangent frames, as uber/lib/normal_map.glsl names them.

#include "uber/reference/numbers.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

// Duff et al. 2017.
template <class T>
Mat3<T> frame_of_normal(const Vec3<T>& n) {
    const T s = n.z < T(0) ? T(-1) : T(1);
    const T a = T(-1) / (s + n.z), b = n.x * n.y * a;
    return {{{T(1) + s * n.x * n.x * a, s * b, -s * n.x}, {b, s + n.y * n.y * a, -n.y}, n}};
}

// Gram and Schmidt, twice: in exact arithmetic the second pass changes nothing.
template <class T>
Mat3<T> tangent_frame(const Vec3<T>& n, const Vec3<T>& t, const T& handedness) {
    const Vec3<T> unit = safe_normalize(t, splat3(T(0)));
    const Vec3<T> across = unit - n * dot(n, unit);
    const T size2 = dot(across, across);
    if (size2 < T(1e-6)) return frame_of_normal(n);
    const Vec3<T> again = across * inversesqrt(size2);
    const Vec3<T> tangent = normalize(again - n * dot(n, again));
    return {{tangent, cross(n, tangent) * (handedness < T(0) ? T(-1) : T(1)), n}};
}

// The surface gradients of u and v, from dp_x.grad u = du_x, dp_y.grad u = du_y, n.grad u = 0 (Cramer's rule).
template <class T>
Mat3<T> cotangent_frame(const Vec3<T>& n, const Vec3<T>& dp_x, const Vec3<T>& dp_y, const Vec2<T>& duv_x, const Vec2<T>& duv_y) {
    const auto largest = [](const Vec3<T>& d) { return max(max(abs(d.x), abs(d.y)), abs(d.z)); };
    const auto direction = [](const Vec2<T>& d) { return d / max(max(abs(d.x), abs(d.y)), T(1e-30)); };
    const T size_x = largest(dp_x), size_y = largest(dp_y);
    const T area = dot(cross(safe_normalize(dp_x, splat3(T(0))), safe_normalize(dp_y, splat3(T(0)))), n);
    const Vec2<T> x = direction(duv_x), y = direction(duv_y);
    if (abs(x.x * y.y - x.y * y.x) < T(1e-4) || abs(area) < T(1e-4) || size_x < T(1e-30) || size_y < T(1e-30))
        return frame_of_normal(n);
    const T side = area < T(0) ? T(-1) : T(1);
    const Vec3<T> to_x = cross(dp_y / size_y, n) / size_x * side, to_y = cross(n, dp_x / size_x) / size_y * side;
    const Vec3<T> t = to_x * duv_x.x + to_y * duv_y.x, b = to_x * duv_x.y + to_y * duv_y.y;
    return tangent_frame(n, t, dot(cross(n, t), b));
}

template <class T>
Vec3<T> decode_normal_unorm8(const Vec3<T>& texel) {
    return max((texel * T(255) - T(128)) / T(127), splat3(T(-1)));
}

template <class T>
Vec3<T> decode_normal(const Vec3<T>& texel) {
    return texel * T(2) - T(1);
}

template <class T>
Vec3<T> decode_normal_xy(const Vec2<T>& xy) {
    return {xy.x, xy.y, sqrt(max(T(1) - dot(xy, xy), T(0)))};
}

template <class T>
Vec3<T> apply_normal(const Mat3<T>& frame, const Vec3<T>& normal) {
    return safe_normalize(frame * normal, frame.columns[2]);
}

}  // namespace kiln::reference
