#pragma once
// Whether a light arrives, as uber/surface_shadow.glsl has it.

#include "uber/reference/lecture_shadow.h"
#include "uber/reference/pcf_cascades.h"
#include "uber/reference/pcss.h"
#include "uber/reference/shadow_map.h"
#include "uber/reference/surface_blocks.h"
#include "uber/reference/vsm.h"

namespace kiln::reference {

inline int pcf_taps(SurfaceShadow shadow) { return shadow == SurfaceShadow::pcf3 ? 3 : shadow == SurfaceShadow::pcf5 ? 5 : 7; }

// maps.cascade(layer, uv, depth).
template <class T, class Maps>
T cascaded_visibility(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& position,
                      const Vec3<T>& n, const Vec3<T>& l) {
    const Vec4<T> at{position.x, position.y, position.z, T(1)};
    const T depth = (read<T>(b.view_projection) * at).w;
    const CascadeChoice<T> choice =
        choose_cascade(depth, T(b.cascade_start), read<T>(b.cascade_ends), axes.cascades, T(b.cascade_band));
    if (choice.index < 0) return T(1);
    const auto compare = [&](int layer, const Vec2<T>& uv, const T& z) { return maps.cascade(layer, uv, z); };
    std::array<Mat4<T>, 4> matrices, planes;
    for (size_t i = 0; i < 4; ++i) {
        matrices[i] = read<T>(b.cascade_view_projection[i]);
        planes[i] = read<T>(b.cascade_plane_of_world[i]);
    }
    if (axes.shadow == SurfaceShadow::hard) {
        const double texels[] = {b.cascade_texel.x, b.cascade_texel.y, b.cascade_texel.z, b.cascade_texel.w};
        const double biases[] = {b.cascade_bias.x, b.cascade_bias.y, b.cascade_bias.z, b.cascade_bias.w};
        const auto own = static_cast<size_t>(choice.index), next = static_cast<size_t>(std::max(choice.next, 0));
        const auto clip = [&](size_t layer) {
            const Vec3<T> r = offset_shadow_receiver(position, n, dot(n, l), T(texels[layer]));
            return matrices[layer] * Vec4<T>{r.x, r.y, r.z, T(1)};
        };
        return cascaded_shadow(compare, clip(own), clip(next), Vec2<T>{T(biases[own]), T(biases[next])}, choice);
    }
    return cascaded_pcf(compare, matrices, planes, read<T>(b.cascade_filter), T(b.cascade_texel_uv), T(b.cascade_quantum),
                        position, n, choice, pcf_taps(axes.shadow));
}

// maps.shadow_cube(direction, depth), maps.moments_cube(direction).
template <class T, class Maps>
T point_visibility(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& position, const Vec3<T>& n) {
    const Vec3<T> light = read<T>(b.light_position), from_light = position - light;
    const T away = max_component(map(from_light, [](const T& x) { return abs(x); }));
    if (axes.shadow == SurfaceShadow::vsm)
        return vsm_factor(maps.moments_cube(from_light), away, T(b.moments_far), T(b.moments_reference), T(b.moments_least),
                          T(b.moments_bleeding));
    const T cosine = cube_axis_cosine(from_light, n, T(b.shadow_texel));
    const Vec3<T> receiver = offset_shadow_receiver(position, n, cosine, T(b.shadow_texel) * away);
    return shadow_factor_cube(maps.shadow_cube, receiver - light, T(b.shadow_near), T(b.shadow_far), T(b.shadow_depth_bias));
}

// maps.shadow(uv, depth), maps.depth(uv), maps.moments(uv, level), maps.moments_sum(x, y) of maps.moments_size().
template <class T, class Maps>
T light_visibility(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& position, const Vec3<T>& n,
                   const Vec3<T>& l) {
    if (axes.shadow == SurfaceShadow::none) return T(1);
    if (axes.cascades > 1) return cascaded_visibility(axes, b, maps, position, n, l);
    if (axes.light == SurfaceLight::point) return point_visibility(axes, b, maps, position, n);
    const bool directional = axes.light == SurfaceLight::directional;
    const Mat4<T> matrix = read<T>(b.shadow_view_projection);
    const Vec4<T> clip = matrix * Vec4<T>{position.x, position.y, position.z, T(1)};
    const auto compare = [&](const Vec2<T>& uv, const T& depth) { return maps.shadow(uv, depth); };
    const auto depth_at = [&](const Vec2<T>& uv) { return maps.depth(uv); };
    const T near(b.shadow_near), far(b.shadow_far), extent(b.shadow_extent), texel(b.shadow_texel_uv), size(b.light_size);
    const T reference(b.moments_reference), least(b.moments_least), bleeding(b.moments_bleeding);
    if (axes.shadow == SurfaceShadow::hard) {
        const T cosine = directional ? dot(n, l) : perspective_axis_cosine(matrix, n);
        const Vec3<T> r = offset_shadow_receiver(position, n, cosine, T(b.shadow_texel) * max(clip.w, T(0)));
        return shadow_factor_2d(compare, matrix * Vec4<T>{r.x, r.y, r.z, T(1)}, T(b.shadow_depth_bias));
    }
    if (axes.shadow == SurfaceShadow::lecture) return shadow_factor_lecture(depth_at, clip);
    if (axes.shadow == SurfaceShadow::vssm) {
        const auto texel_at = [&](int x, int y) { return maps.template moments_sum<T>(x, y); };
        const auto average = [&](const Vec2<T>& centre, const Vec2<T>& width) {
            return sat_average(texel_at, maps.moments_size(), centre, width);
        };
        return vssm_factor(average, clip, size, near, far, extent, texel, reference, least, bleeding);
    }
    const Vec4<T> place = shadow_coordinates(clip);
    if (axes.shadow == SurfaceShadow::vsm) {
        if (!(place.w > T(0))) return T(1);
        const auto at = [&](const Vec2<T>& uv, const T& level) { return maps.moments(uv, level); };
        const Vec2<T> width{T(b.shadow_filter), T(b.shadow_filter)};
        const Vec2<T> moments = mip_average(at, maps.moments_size(), place.xy(), width, T(b.moments_levels));
        return directional ? vsm_factor(moments, place.z, T(1), reference, least, bleeding)
                           : vsm_factor(moments, clip.w, T(b.moments_far), reference, least, bleeding);
    }
    const Vec4<T> plane{n.x, n.y, n.z, -dot(n, position)};
    const Vec2<T> slope = receiver_depth_slope(read<T>(b.shadow_plane_of_world) * plane, T(64));
    const T bias = receiver_depth_bias(slope, Vec2<T>{texel, texel}, T(b.shadow_quantum));
    const Vec2<T> none{T(0), T(0)};
    if (axes.shadow == SurfaceShadow::pcss)
        return directional ? pcss_factor_directional(depth_at, compare, clip, slope, bias, size, far, extent, texel, none)
                           : pcss_factor(depth_at, compare, clip, slope, bias, size, near, far, extent, texel, none);
    if (!(place.w > T(0))) return T(1);
    return pcf_box(compare, place.xyz(), slope, bias, Vec2<T>{T(b.shadow_filter), T(b.shadow_filter)}, pcf_taps(axes.shadow));
}

}  // namespace kiln::reference
