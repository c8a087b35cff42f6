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
T cascaded_pcf(const Compare& maps, const std::array<Mat4<T>, 4>& clip_of_world, const std::array<Mat4<T>, 4>& plane_of_world,
               const Vec4<T>& width, const T& texel, const T& quantum, const Vec3<T>& receiver, const Vec3<T>& n,
               const CascadeChoice<T>& choice, int taps) {
    const T widths[] = {width.x, width.y, width.z, width.w};
    const Vec4<T> world{receiver.x, receiver.y, receiver.z, T(1)}, plane{n.x, n.y, n.z, -dot(n, receiver)};
    const auto layer = [&](int i) {
        if (i < 0) return T(1);
        const auto at = static_cast<size_t>(i);
        const Vec2<T> slope = receiver_depth_slope(plane_of_world[at] * plane, T(64));
        const T bias = receiver_depth_bias(slope, Vec2<T>{texel, texel}, quantum);
        return cascade_pcf(maps, clip_of_world[at] * world, i, slope, bias, widths[i], taps);
    };
    if (choice.index < 0) return T(1);
    if (!(choice.blend > T(0))) return layer(choice.index);
    return mix(layer(choice.index), layer(choice.next), choice.blend);
}

}  // namespace kiln::reference
