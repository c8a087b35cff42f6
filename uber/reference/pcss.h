#pragma once
// Percentage-closer soft shadows, as uber/lib/pcss.glsl names them. Depth is a callable uv -> depth, a comparison map one of
// (uv, depth) -> 1 lit or 0. What the shader takes as macros stands in PcssTaps.

#include <array>
#include <numeric>

#include "uber/reference/pcf.h"
#include "uber/reference/shadow_receiver.h"

namespace kiln::reference {

struct PcssTaps {
    int blocker = 32, filter = 32;
    bool disk_light = false;
};

// The z whose depth under a perspective from near to far is `depth`: depth = far (z - near) / (z (far - near)).
template <class T>
T light_distance(const T& depth, const T& near, const T& far) {
    return near * far / (far - depth * (far - near));
}

template <class T>
T map_distance(const T& depth, const T& near, const T& far) {
    return near > T(0) ? light_distance(depth, near, far) : far * depth;
}

template <class T>
T pcss_search_width(const T& receiver, const T& near, const T& size) {
    return receiver > near ? size * (receiver - near) / receiver : T(0);
}

template <class T>
T pcss_penumbra_width(const T& receiver, const T& blocker, const T& size, const T& least, const T& most) {
    return clamp(size * (receiver - blocker) / max(blocker, T(1e-6)), least, most);
}

template <class T>
T pcss_penumbra_width_directional(const T& receiver, const T& blocker, const T& angular_size, const T& least, const T& most) {
    return clamp(angular_size * (receiver - blocker), least, most);
}

// The least step coprime to the count whose lattice's shortest vector on the torus is longest.
inline int pcss_step(int count) {
    const auto search = [](int n) {
        int best = 1, longest = 0;
        for (int step = 1; step <= n / 2; ++step) {
            if (std::gcd(step, n) != 1) continue;
            int shortest = n * n;
            for (int i = 1; i < n; ++i) {
                const int x = std::min(i, n - i), k = i * step % n, y = std::min(k, n - k);
                shortest = std::min(shortest, x * x + y * y);
            }
            if (shortest > longest) longest = shortest, best = step;
        }
        return best;
    };
    static const std::array<int, 257> steps = [&] {
        std::array<int, 257> out{};
        for (int n = 1; n <= 256; ++n) out[static_cast<size_t>(n)] = search(n);
        return out;
    }();
    return steps[static_cast<size_t>(count)];
}

template <class T>
Vec2<T> pcss_square_tap(int i, int count, const Vec2<T>& jitter) {
    const int step = pcss_step(count);
    const auto cell = [&](int k, const T& shift) { return fract((T(k) + T(0.5)) / T(count) + shift) - T(0.5); };
    return {cell(i, jitter.x), cell((i * step) % count, jitter.y)};
}

// 0.38196601: the golden angle in turns, 2 - (1 + sqrt(5)) / 2.
template <class T>
Vec2<T> pcss_disk_tap(int i, int count, const T& turn) {
    const T radius = T(0.5) * sqrt((T(i) + T(0.5)) / T(count));
    const Vec2<T> direction = cos_sin_of_turn(fract(T(i) * T(0.38196601) + turn));
    return {radius * direction.x, radius * direction.y};
}

template <class T>
Vec2<T> pcss_tap(int i, int count, const Vec2<T>& jitter, bool disk_light = false) {
    return disk_light ? pcss_disk_tap(i, count, jitter.x) : pcss_square_tap(i, count, jitter);
}

template <class T, class Depth>
Vec2<T> pcss_blockers(const Depth& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& width,
                      const T& near, const T& far, const Vec2<T>& jitter, const PcssTaps& taps = {}) {
    T sum(0);
    int blockers = 0;
    for (int i = 0; i < taps.blocker; ++i) {
        const Vec2<T> offset = pcss_tap(i, taps.blocker, jitter, taps.disk_light) * width;
        const Vec2<T> uv = place.xy() + offset;
        const T receiver = place.z + dot(slope, offset) - bias;
        if (!(uv.x >= T(0) && uv.y >= T(0) && uv.x <= T(1) && uv.y <= T(1) && receiver <= T(1))) continue;
        const T depth = saturate(T(map(uv)));
        if (!(depth < receiver)) continue;
        sum = sum + map_distance(depth, near, far);
        ++blockers;
    }
    return {blockers > 0 ? sum / T(blockers) : T(0), T(blockers) / T(taps.blocker)};
}

template <class T, class Compare>
T pcss_filter(const Compare& map, const Vec3<T>& place, const Vec2<T>& slope, const T& bias, const Vec2<T>& width,
              const Vec2<T>& jitter, const PcssTaps& taps = {}) {
    T lit(0);
    for (int i = 0; i < taps.filter; ++i)
        lit = lit + shadow_tap(map, place, slope, bias, pcss_tap(i, taps.filter, jitter, taps.disk_light) * width);
    return lit / T(taps.filter);
}

template <class T, class Depth, class Compare>
T pcss_factor(const Depth& depth_map, const Compare& shadow_map, const Vec4<T>& clip, const Vec2<T>& slope, const T& bias,
              const T& size, const T& near, const T& far, const T& extent, const T& texel, const Vec2<T>& jitter,
              const PcssTaps& taps = {}) {
    const Vec4<T> place = shadow_coordinates(clip);
    if (!(place.w > T(0))) return T(1);
    const T receiver = clamp(clip.w, near, far);
    const T search = max(pcss_search_width(receiver, near, size) / (extent * near), texel);
    const Vec2<T> blockers = pcss_blockers(depth_map, place.xyz(), slope, bias, Vec2<T>{search, search}, near, far, jitter, taps);
    if (!(blockers.y > T(0))) return T(1);
    const T metres = extent * receiver;  // of the map's width at the receiver
    const T width = pcss_penumbra_width(receiver, blockers.x, size, texel * metres, search * metres) / metres;
    return pcss_filter(shadow_map, place.xyz(), slope, bias, Vec2<T>{width, width}, jitter, taps);
}

template <class T, class Depth, class Compare>
T pcss_factor_directional(const Depth& depth_map, const Compare& shadow_map, const Vec4<T>& clip, const Vec2<T>& slope,
                          const T& bias, const T& angular_size, const T& range, const T& extent, const T& texel,
                          const Vec2<T>& jitter, const PcssTaps& taps = {}) {
    const Vec4<T> place = shadow_coordinates(clip);
    if (!(place.w > T(0))) return T(1);
    const T search = max(angular_size * place.z * range / extent, texel);
    const Vec2<T> blockers =
        pcss_blockers(depth_map, place.xyz(), slope, bias, Vec2<T>{search, search}, T(0), range, jitter, taps);
    if (!(blockers.y > T(0))) return T(1);
    const T width = pcss_penumbra_width_directional(place.z * range, blockers.x, angular_size, texel * extent, search * extent);
    return pcss_filter(shadow_map, place.xyz(), slope, bias, Vec2<T>{width / extent, width / extent}, jitter, taps);
}

}  // namespace kiln::reference
