#pragma once
// Percentage-closer filtering in cascades, as uber/lib/pcf_cascades.glsl names it. maps: callable (layer, uv, depth) -> 1 lit or
// 0.

#include "uber/reference/cascades.h"
#include "uber/reference/pcf.h"

namespace kiln::reference {

template <class T, class Compare>
T cascade_pcf(const Compare& maps, const Vec4<T>& clip, int layer, const Vec2<T>& slope, const T& bias, const T& width, int n) {
    const Vec4<T> place = shadow_coordinates(clip);
    if (!(place.w > T(0))) return T(1);
    const auto one = [&](const Vec2<T>& uv, const T& depth) { return maps(layer, uv, depth); };
    return pcf_box(one, Vec3<T>{place.x, place.y, place.z}, slope, bias, Vec2<T>{width, width}, n);
}

template <class T, class Compare>
T cascade_pcf_layer(const Compare& maps, const Vec4<T>& clip, const Vec4<T>& plane, int layer, const T& width, const T& texel,
                    const T& quantum, int taps) {
    if (layer < 0) return T(1);
    const Vec2<T> slope = receiver_depth_slope(plane, T(64));
    return cascade_pcf(maps, clip, layer, slope, receiver_depth_bias(slope, Vec2<T>{texel, texel}, quantum), width, taps);
}

template <class T, class Compare>
T cascaded_pcf(const Compare& maps, const Vec4<T>& clip, const Vec4<T>& plane, const Vec4<T>& next_clip,
               const Vec4<T>& next_plane, const Vec2<T>& width, const T& texel, const T& quantum, const CascadeChoice<T>& choice,
               int taps) {
    if (choice.index < 0) return T(1);
    const T own = cascade_pcf_layer(maps, clip, plane, choice.index, width.x, texel, quantum, taps);
    if (!(choice.blend > T(0))) return own;
    return mix(own, cascade_pcf_layer(maps, next_clip, next_plane, choice.next, width.y, texel, quantum, taps), choice.blend);
}

// As a renderer calls it.
template <class T, class Compare>
T cascaded_pcf(const Compare& maps, const std::array<Mat4<T>, 4>& clip_of_world, const std::array<Mat4<T>, 4>& plane_of_world,
               const Vec4<T>& width, const T& texel, const T& quantum, const Vec3<T>& receiver, const Vec3<T>& n,
               const CascadeChoice<T>& choice, int taps) {
    const T widths[] = {width.x, width.y, width.z, width.w};
    const Vec4<T> world{receiver.x, receiver.y, receiver.z, T(1)}, plane{n.x, n.y, n.z, -dot(n, receiver)};
    const auto own = static_cast<size_t>(std::max(choice.index, 0)), next = static_cast<size_t>(std::max(choice.next, 0));
    return cascaded_pcf(maps, clip_of_world[own] * world, plane_of_world[own] * plane, clip_of_world[next] * world,
                        plane_of_world[next] * plane, Vec2<T>{widths[own], widths[next]}, texel, quantum, choice, taps);
}

}  // namespace kiln::reference
