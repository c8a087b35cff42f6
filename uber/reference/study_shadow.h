#pragma once
// The shadow of one map on a receiver, as uber/study_shadow.frag has it: the filter by its name in manifests/library.yaml.

#include <array>
#include <string>
#include <vector>

#include "uber/reference/bounded.h"
#include "uber/reference/cascades.h"
#include "uber/reference/lecture_shadow.h"
#include "uber/reference/pcf.h"
#include "uber/reference/pcss.h"
#include "uber/reference/shadow_map.h"
#include "uber/reference/shadow_receiver.h"
#include "uber/reference/texture.h"
#include "uber/reference/vsm.h"

namespace kiln::reference {

struct ShadowBlock {
    std::array<Mat4<double>, 2> cascade_view_projection;
    Vec2<double> receiver_share;
    double shadow_near = 0, shadow_far = 0, shadow_extent = 0, light_width = 0, filter_width = 0, map_texel = 0, filter_turn = 0,
           moments_middle = 0, moments_least = 0, moments_bleeding = 0, moments_levels = 0, cascade_end = 0;
};

struct ShadowMaps {
    DepthMap shadow_map{1, 1, {1}};
    MomentMips moment_map, depth_moments;
    Texture2D moment_sums;
    std::vector<DepthMap> cascade_maps;
};

template <class T>
T study_shadow(const std::string& filter, const ShadowBlock& b, const ShadowMaps& maps, const Vec2<T>& uv) {
    const T near(b.shadow_near), far = max(T(b.shadow_far), T(2) * near);
    const T distance = far * mix(T(b.receiver_share.x), T(b.receiver_share.y), uv.y);
    const T depth = far * (distance - near) / (distance * (far - near));
    const Vec2<T> ndc{uv.x * T(2) - T(1), uv.y * T(2) - T(1)};
    const Vec4<T> clip{ndc.x * distance, ndc.y * distance, depth * distance, distance};
    const T rise = far * near / (distance * distance * (far - near)) * far * (T(b.receiver_share.y) - T(b.receiver_share.x));
    const T texel(b.map_texel), width(b.filter_width), size(b.light_width), extent(b.shadow_extent), turn(b.filter_turn);
    const T middle(b.moments_middle), least(b.moments_least), bleeding(b.moments_bleeding), levels(b.moments_levels);
    const Vec2<T> slope{T(0), clamp(rise, T(-64), T(64))}, square{width, width}, none{T(0), T(0)};
    const T bias = receiver_depth_bias(slope, Vec2<T>{texel, texel}, T(1.1920929e-7));
    const auto compare = [&](const Vec2<T>& at, const T& z) { return filtered_comparison(maps.shadow_map, at, z); };
    const auto depth_at = [&](const Vec2<T>& at) { return nearest_depth(maps.shadow_map, at); };
    const auto moments = [&](const Vec2<T>& at, const T& level) { return maps.moment_map(at, level); };
    const int side = static_cast<int>(maps.moment_sums.width());

    if (filter == "cascades" || filter == "lecture_cascades") {
        const auto layer = [&](int i, const Vec2<T>& at, const T& z) {
            return filtered_comparison(maps.cascade_maps[static_cast<size_t>(i)], at, z);
        };
        std::array<Mat4<T>, 4> matrices;
        for (size_t i = 0; i < 4; ++i)
            for (size_t c = 0; c < 4; ++c) {
                const Vec4<double>& v = b.cascade_view_projection[std::min<size_t>(i, 1)].columns[c];
                matrices[i].columns[c] = {T(v.x), T(v.y), T(v.z), T(v.w)};
            }
        const Vec3<T> receiver{ndc.x, ndc.y, depth};
        if (filter == "cascades")
            return cascaded_shadow(layer, matrices, Vec4<T>{T(0), T(0), T(0), T(0)}, receiver,
                                   choose_cascade(depth, T(0), Vec4<T>{T(b.cascade_end), T(1), T(1), T(1)}, 2, T(0)));
        const Mat4<T> all[4] = {matrices[0], matrices[1], matrices[2], matrices[3]};
        return cascaded_shadow_lecture(layer, all, receiver, 2, depth < T(b.cascade_end) ? 0 : 1);
    }
    if (filter == "lecture") return shadow_factor_lecture(depth_at, clip);
    if (filter == "lecture_unbiased") return shadow_factor_unbiased_lecture(depth_at, clip);
    if (filter == "hard") return shadow_factor_2d(compare, clip, bias);
    if (filter == "pcss_square" || filter == "pcss_disk") {
        PcssTaps taps;
        taps.disk_light = filter == "pcss_disk";
        return pcss_factor(depth_at, compare, clip, slope, bias, size, near, far, extent, texel, none, taps);
    }
    if (filter == "vssm") {
        const auto texel_at = [&](int x, int y) {
            return Vec2<T>{T(maps.moment_sums.texel(x, y, 0)), T(maps.moment_sums.texel(x, y, 1))};
        };
        const auto average = [&](const Vec2<T>& centre, const Vec2<T>& w) { return sat_average(texel_at, side, centre, w); };
        return vssm_factor(average, clip, size, near, far, extent, texel, middle, least, bleeding);
    }
    if (filter == "vssm_mips")
        return vssm_factor_mips(moments, side, levels, clip, size, near, far, extent, texel, middle, least, bleeding);

    const Vec4<T> place = shadow_coordinates(clip);
    if (!(place.w > T(0))) return T(1);
    const Vec3<T> at = place.xyz();
    const Vec2<T> radius{T(0.5) * width, T(0.5) * width};
    if (filter.rfind("pcf_", 0) == 0) return pcf_box(compare, at, slope, bias, square, filter.back() - '0');
    if (filter == "poisson_16") return pcf_poisson_16(compare, at, slope, bias, radius, turn);
    if (filter == "poisson_32") return pcf_poisson_32(compare, at, slope, bias, radius, turn);
    if (filter == "vsm")
        return vsm_factor(mip_average(moments, side, place.xy(), square, levels), distance, far, middle, least, bleeding);
    if (filter == "lecture_pcss") {
        const T search = max(pcss_search_width(distance, near, size) / (extent * near), texel);
        const Vec2<T> met = pcss_blockers(depth_at, at, slope, bias, Vec2<T>{search, search}, near, far, none);
        if (!(met.y > T(0))) {
            decision_was_close = true;  // 0 / 0, of which GLSL says nothing
            return T(1);
        }
        const T blocker = pcss_mean_blocker_lecture(met.x * met.y, met.y);
        const T penumbra = pcss_penumbra_width_lecture(distance, blocker, size) / (extent * distance);
        return pcss_filter(compare, at, slope, bias, Vec2<T>{penumbra, penumbra}, none);
    }
    const auto plain = [&](const Vec2<T>& uv_of, const T& level) { return maps.depth_moments(uv_of, level); };
    return chebyshev_lecture(mip_average(plain, side, place.xy(), square, levels), place.z);
}

}  // namespace kiln::reference
