#pragma once
// Environment look-up as uber/lib/environment.glsl and lecture_environment.glsl name it. A cube map is a callable from a
// direction and a level to radiance, an equirectangular picture one from uv and a level.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> environment_reflection(const Vec3<T>& n, const Vec3<T>& v) {
    return n * (T(2) * dot(n, v)) - v;
}
template <class T>
Vec3<T> environment_reflection_lecture(const Vec3<T>& n, const Vec3<T>& v) {
    return reflect(v, n);
}

template <class T>
T environment_lod(const T& roughness, const T& levels) {
    return saturate(roughness) * max(levels - T(1), T(0));
}

template <class Map, class T>
Vec3<T> sample_environment(const Map& map, const Vec3<T>& r, const T& roughness, const T& levels) {
    const bool is_direction = max(max(abs(value(r.x)), abs(value(r.y))), abs(value(r.z))) > 1e-30;
    return map(is_direction ? r : Vec3<T>{T(0), T(1), T(0)}, environment_lod(roughness, levels));
}

// Vulkan 1.3, table "Cube map face and coordinate selection": major axis, s and t of a layer.
template <class T>
int cube_face(const Vec3<T>& d) {
    const double x = value(d.x), y = value(d.y), z = value(d.z);
    if (abs(z) >= abs(x) && abs(z) >= abs(y)) return z < 0.0 ? 5 : 4;
    if (abs(y) >= abs(x)) return y < 0.0 ? 3 : 2;
    return x < 0.0 ? 1 : 0;
}
template <class T>
Vec2<T> cube_face_coordinates(const Vec3<T>& d, int face) {
    switch (face) {
        case 0:
            return Vec2<T>{-d.z, -d.y} / abs(d.x);
        case 1:
            return Vec2<T>{d.z, -d.y} / abs(d.x);
        case 2:
            return Vec2<T>{d.x, d.z} / abs(d.y);
        case 3:
            return Vec2<T>{d.x, -d.z} / abs(d.y);
        case 4:
            return Vec2<T>{d.x, -d.y} / abs(d.z);
        default:
            return Vec2<T>{-d.x, -d.y} / abs(d.z);
    }
}
template <class T>
Vec3<T> cube_direction(int face, const Vec2<T>& p) {
    const T one = T(1);
    switch (face) {
        case 0:
            return {one, -p.y, -p.x};
        case 1:
            return {-one, -p.y, p.x};
        case 2:
            return {p.x, one, p.y};
        case 3:
            return {p.x, -one, -p.y};
        case 4:
            return {p.x, -p.y, one};
        default:
            return {-p.x, -p.y, -one};
    }
}
template <class T>
Vec2<T> cube_texel_centre(int x, int y, int size) {
    const auto centre = [size](int i) { return T(2.0 * (i + 0.5) / size - 1.0); };
    return {centre(x), centre(y)};
}
// The midpoint form, as the shader has it; cube_rectangle_solid_angle is the truth.
template <class T>
T cube_texel_solid_angle(const Vec2<T>& p, const T& size) {
    const T d2 = T(1) + dot(p, p);
    return T(4) / (size * size * d2 * sqrt(d2));
}
// Exact: the rectangle [low, high] of the plane at distance 1.
inline double cube_rectangle_solid_angle(const Vec2<double>& low, const Vec2<double>& high) {
    const auto corner = [](double x, double y) { return std::atan2(x * y, std::sqrt(x * x + y * y + 1.0)); };
    return corner(high.x, high.y) - corner(low.x, high.y) - corner(high.x, low.y) + corner(low.x, low.y);
}

// u from the azimuth, v from the angle to +y. u is 0.5 within 1e-7 of a pole, where the azimuth has no digits left.
template <class T>
Vec2<T> equirect_uv(const Vec3<T>& d) {
    const Vec3<T> s = d / max(max(abs(d.x), abs(d.y)), max(abs(d.z), T(1e-30)));
    const T horizontal = sqrt(s.x * s.x + s.z * s.z);
    const bool pole = value(horizontal) < 1e-7;
    const T azimuth = pole ? T(0) : atan(s.z, s.x);
    return {azimuth / T(2.0 * pi) + T(0.5), atan(horizontal, s.y) / T(pi)};
}
template <class T>
Vec3<T> equirect_direction(const Vec2<T>& uv) {
    const T azimuth = (uv.x - T(0.5)) * T(2.0 * pi), polar = uv.y * T(pi);
    return {sin(polar) * cos(azimuth), cos(polar), sin(polar) * sin(azimuth)};
}
// rows: of the coarser level that is read.
template <class Picture, class T>
Vec3<T> sample_equirect(const Picture& picture, const Vec3<T>& d, const T& lod, const T& rows) {
    const Vec2<T> uv = equirect_uv(d);
    return picture(Vec2<T>{uv.x, clamp(uv.y, T(0.5) / rows, T(1) - T(0.5) / rows)}, lod);
}

template <class T>
Vec3<T> environment_clamped(const Vec3<T>& radiance, const T& limit) {
    return min(radiance, splat3(limit));
}
template <class T>
Vec3<T> environment_excess(const Vec3<T>& radiance, const T& limit) {
    return max(radiance - splat3(limit), splat3(T(0)));
}

}  // namespace kiln::reference
