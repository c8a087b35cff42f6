#pragma once
// Percentage-closer filtering, as uber/lib/pcf.glsl names it. A map is a callable (uv, depth) -> 1 lit or 0.

#include <cstdint>

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T, class Compare>
T shadow_tap(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& offset) {
    const Vec2<T> uv = place.xy() + offset;
    const T depth = place.z + dot(slope, offset) - bias;
    const bool inside = uv.x >= T(0) && uv.y >= T(0) && uv.x <= T(1) && uv.y <= T(1) && depth <= T(1);
    return inside ? map(uv, depth) : T(1);
}

// Mean over the centres of n x n parts of a box.
template <class T, class Compare>
T pcf_box(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& width, int n) {
    T lit(0);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const Vec2<T> offset{(T(2 * x + 1 - n) / T(2 * n)) * width.x, (T(2 * y + 1 - n) / T(2 * n)) * width.y};
            lit = lit + shadow_tap(map, place, slope, bias, offset);
        }
    return lit / T(n * n);
}

// The shader's tables.
inline constexpr Vec2<double> poisson_disk_16[16] = {
    {-0.0708, 0.3642}, {-0.3696, 0.0376},  {0.3309, 0.1804},  {-0.1510, -0.3460}, {0.2802, -0.2571},  {-0.5965, 0.5539},
    {-0.8005, 0.1478}, {-0.2063, 0.7875},  {0.2532, 0.7738},  {-0.7529, -0.3102}, {-0.4706, -0.6647}, {0.6278, 0.5189},
    {0.8097, 0.0891},  {-0.0276, -0.8142}, {0.4123, -0.7027}, {0.7319, -0.3580}};
inline constexpr Vec2<double> poisson_disk_32[32] = {
    {0.1697, -0.1863}, {-0.0263, 0.2511},  {-0.2564, 0.0528},  {-0.1313, -0.2274}, {0.2446, 0.1098},   {-0.4937, -0.2216},
    {0.2693, 0.4696},  {0.5299, -0.1109},  {0.0581, -0.5384},  {-0.3637, 0.4013},  {0.3802, -0.4153},  {-0.0573, 0.5606},
    {-0.5603, 0.1112}, {-0.2895, -0.4931}, {0.5256, 0.2363},   {-0.8587, -0.0489}, {0.8526, -0.1135},  {-0.0303, -0.8596},
    {-0.8154, 0.2738}, {-0.6042, -0.6122}, {0.4780, 0.7151},   {0.7014, 0.4979},   {-0.7838, -0.3543}, {-0.1299, 0.8503},
    {0.8372, 0.1975},  {-0.4244, 0.7482},  {-0.3328, -0.7932}, {0.7544, -0.4133},  {0.1880, 0.8394},   {-0.6656, 0.5449},
    {0.2816, -0.8128}, {0.5530, -0.6589}};

template <class T>
Vec2<T> turned(const Vec2<T>& point, const Vec2<T>& cos_sin) {
    return {point.x * cos_sin.x - point.y * cos_sin.y, point.x * cos_sin.y + point.y * cos_sin.x};
}

template <class T, class Compare, int n>
T pcf_poisson(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& radius, const T& turn,
              const Vec2<double> (&disk)[n]) {
    const Vec2<T> cos_sin = cos_sin_of_turn(turn);
    T lit(0);
    for (const Vec2<double>& p : disk)
        lit = lit + shadow_tap(map, place, slope, bias, turned(Vec2<T>{T(p.x), T(p.y)}, cos_sin) * radius);
    return lit / T(n);
}
template <class T, class Compare>
T pcf_poisson_16(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& radius,
                 const T& turn) {
    return pcf_poisson(map, place, slope, bias, radius, turn, poisson_disk_16);
}
template <class T, class Compare>
T pcf_poisson_32(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& radius,
                 const T& turn) {
    return pcf_poisson(map, place, slope, bias, radius, turn, poisson_disk_32);
}

// The upper 24 bits of PCG, as a share of 2^24: exact in any arithmetic.
inline double pixel_hash(uint32_t x, uint32_t y) {
    const uint32_t state = (x + y * 65536u) * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return static_cast<double>(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

}  // namespace kiln::reference
