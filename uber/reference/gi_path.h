#pragma once
// What uber/lib/gi_path.glsl computes from a scene of rectangles. `quads` is any range of GiQuad<T>.

#include "uber/reference/gi_quad.h"
#include "uber/reference/gi_sampling.h"
#include "uber/reference/gi_sdf.h"

namespace kiln::reference {

template <class T, class Quads>
int gi_trace(const Quads& quads, const Vec3<T>& origin, const Vec3<T>& direction, const T& start, const T& reach, T& t) {
    int nearest = -1, i = 0;
    t = reach;
    for (const GiQuad<T>& quad : quads) {
        const Vec3<T> n = cross(quad.u, quad.v), d = quad.origin - origin;
        const T slope = dot(n, direction), at = dot(n, d) / slope;
        if (std::fabs(value(slope)) >= 1e-30 && at > start && at < t) {
            const Vec3<T> p = direction * at - d;
            const T a = dot(p, quad.u) / dot(quad.u, quad.u), b = dot(p, quad.v) / dot(quad.v, quad.v);
            if (a >= T(0) && a <= T(1) && b >= T(0) && b <= T(1)) {
                t = at;
                nearest = i;
            }
        }
        ++i;
    }
    return nearest;
}

template <class T, class Quads>
bool gi_meet(const Quads& quads, const Vec3<T>& origin, const Vec3<T>& direction, const T& start, const T& reach, T& t,
             Vec3<T>& n, Vec3<T>& albedo, Vec3<T>& emission) {
    const int i = gi_trace(quads, origin, direction, start, reach, t);
    n = albedo = emission = splat3(T(0));
    if (i < 0) return false;
    const GiQuad<T>& quad = quads[static_cast<std::size_t>(i)];
    n = normalize(cross(quad.u, quad.v)), albedo = quad.albedo, emission = quad.emission;
    return true;
}

template <class T, class Quads>
Vec3<T> gi_direct(const Quads& quads, const GiLamp<T>& lamp, const Vec3<T>& x, const Vec3<T>& n) {
    const Vec3<T> d = lamp.position - x;
    const T square = max(dot(d, d), T(1e-8)), far = sqrt(square);
    const Vec3<T> l = d / far;
    if (dot(n, l) <= T(0) || dot(lamp.axis, l) >= T(0)) return splat3(T(0));
    T t;
    if (gi_trace(quads, x, l, T(1e-4), far * T(0.9999), t) >= 0) return splat3(T(0));
    return lamp.intensity * (dot(n, l) / square);
}

// random: () -> double in [0, 1).
template <class T, class Quads, class Random>
Vec3<T> gi_path(const Quads& quads, const GiLamp<T>& lamp, Vec3<T> origin, Vec3<T> direction, int bounces, Random random) {
    Vec3<T> sum = splat3(T(0)), weight = splat3(T(1));
    for (int bounce = 0; bounce <= bounces; ++bounce) {
        T t;
        Vec3<T> n, albedo, emission;
        if (!gi_meet(quads, origin, direction, T(1e-4), T(1e30), t, n, albedo, emission) || dot(n, direction) >= T(0)) break;
        sum = sum + weight * emission;
        if (bounce == bounces) break;
        weight = weight * albedo;
        origin = origin + direction * t;
        sum = sum + weight * gi_direct(quads, lamp, origin, n) / T(pi);
        const T a = T(random()), b = T(random());
        direction = gi_cosine_direction({a, b}, n);
    }
    return sum;
}

template <class T, class Quads>
T gi_distance(const Quads& quads, const Vec3<T>& p) {
    T nearest = T(1e30);
    for (const GiQuad<T>& quad : quads) nearest = min(nearest, sdf_rectangle(p, quad.origin, quad.u, quad.v));
    return nearest;
}

template <class T, class Quads>
Vec4<T> gi_voxel(const Quads& quads, const GiLamp<T>& lamp, const Vec3<T>& centre, const T& size) {
    Vec3<T> sum = splat3(T(0));
    int count = 0;
    for (const GiQuad<T>& quad : quads) {
        const Vec3<T> d = centre - quad.origin;
        const Vec3<T> on = quad.origin + quad.u * saturate(dot(d, quad.u) / dot(quad.u, quad.u)) +
                           quad.v * saturate(dot(d, quad.v) / dot(quad.v, quad.v));
        if (max_component(map(on - centre, [](const T& x) { return abs(x); })) > size / T(2)) continue;
        const Vec3<T> n = normalize(cross(quad.u, quad.v));
        sum = sum + quad.emission + quad.albedo * gi_direct(quads, lamp, on + n * (T(0.01) * size), n) / T(pi);
        ++count;
    }
    if (count == 0) return {T(0), T(0), T(0), T(0)};
    sum = sum / T(count);
    return {sum.x, sum.y, sum.z, T(1)};
}

}  // namespace kiln::reference
