#pragma once
// Light that comes by way of others, as uber/surface_indirect.glsl and surface_environment.glsl have it.

#include "uber/reference/environment_layers.h"
#include "uber/reference/ibl.h"
#include "uber/reference/probes.h"
#include "uber/reference/sh_lightmap.h"
#include "uber/reference/surface_material.h"

namespace kiln::reference {

// The eight probes about a place, each by its trilinear weight: use(probe, weight). Places beyond the grid are on its border.
template <class T, class Use>
void probes_about(const SurfaceBlocks& b, const Vec3<T>& position, const Use& use) {
    const Vec3<T> scaled = (position - read<T>(b.probe_first)) * read<T>(b.probe_inverse_spacing);
    const T along[3] = {scaled.x, scaled.y, scaled.z};
    int cell[3];
    T t[3];
    for (int k = 0; k < 3; ++k) {
        const T inside = clamp(along[k], T(0), T(b.probe_count[k] - 1));
        cell[k] = std::max(0, std::min(to_int(inside), b.probe_count[k] - 2));
        t[k] = inside - T(cell[k]);
    }
    const auto weights = trilinear_weights(Vec3<T>{t[0], t[1], t[2]});
    for (int i = 0; i < 8; ++i) {
        int at[3];
        for (int k = 0; k < 3; ++k) at[k] = std::min(cell[k] + (i >> k & 1), b.probe_count[k] - 1);
        use((at[2] * b.probe_count[1] + at[1]) * b.probe_count[0] + at[0], weights[static_cast<size_t>(i)]);
    }
}

template <class T>
Vec3<T> probe_irradiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Vec3<T>& position, const Vec3<T>& n) {
    const auto coefficient = [&](int probe, int k) { return read<T>(b.probe_sh[9 * probe + k]); };
    if (axes.probes == SurfaceProbes::sh_l1) {
        ShMomentsL1<T> sum{splat3(T(0)), splat3(T(0)), splat3(T(0)), splat3(T(0))};
        probes_about(b, position, [&](int p, const T& weight) {
            sum = sh_add(sum, ShMomentsL1<T>{coefficient(p, 0), coefficient(p, 1), coefficient(p, 2), coefficient(p, 3)}, weight);
        });
        return sh_irradiance_clamped(sum, n);
    }
    ShL2<T> sum;
    for (Vec3<T>& c : sum.c) c = splat3(T(0));
    probes_about(b, position, [&](int p, const T& weight) {
        ShL2<T> one;
        for (int k = 0; k < 9; ++k) one.c[static_cast<size_t>(k)] = coefficient(p, k);
        sum = sh_add(sum, one, weight);
    });
    return sh_irradiance_clamped(sum, n);
}

template <class T>
Vec3<T> sky_irradiance(const SurfaceBlocks& b, const Vec3<T>& n) {
    ShL2<T> sky;
    for (size_t k = 0; k < 9; ++k) sky.c[k] = read<T>(b.sky_sh[k]);
    return sh_irradiance_clamped(sky, n);
}

template <class T, class Maps>
Vec3<T> lightmap_irradiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec2<T>& uv,
                            const Vec3<T>& n) {
    const T range(b.lightmap_range);
    if (axes.lightmap == SurfaceLightmap::flat) return decode_flat_lightmap(maps.lightmap_flat.rgb(uv), range);
    const Vec3<T> m0 = maps.lightmap_l0.rgb(uv) * range, y = decode_sh_ratio(maps.lightmap_l1_y.rgb(uv)),
                  z = decode_sh_ratio(maps.lightmap_l1_z.rgb(uv)), x = decode_sh_ratio(maps.lightmap_l1_x.rgb(uv));
    if (axes.lightmap != SurfaceLightmap::sh_lecture) return sh_l1_irradiance(m0, y, z, x, n);
    const auto channel = [&](const T& m, const T& a, const T& c, const T& d) {
        return sh_irradiance_lecture(Vec4<T>{m, m * a, m * c, m * d}, n);
    };
    return {channel(m0.x, y.x, z.x, x.x), channel(m0.y, y.y, z.y, x.y), channel(m0.z, y.z, z.z, x.z)};
}

template <class T, class Maps>
Vec3<T> surface_irradiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                           const Vec3<T>& n) {
    return relaxed(axes, axes.lightmap != SurfaceLightmap::none ? lightmap_irradiance(axes, b, maps, in.atlas_uv, n)
                         : axes.probes != SurfaceProbes::none   ? probe_irradiance(axes, b, in.world_position, n)
                         : axes.ibl                             ? sky_irradiance(b, n)
                                                                : read<T>(b.ambient_irradiance));
}

template <class T>
Vec3<T> surface_diffuse(const SurfaceAxes& axes, const SurfaceShading<T>& s, const Vec3<T>& irradiance) {
    return relaxed(axes, relaxed(axes, s.diffuse / T(pi)) * irradiance);
}

// maps.environment_maps(direction, layer, level).
template <class T, class Maps>
Vec3<T> environment_radiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& position,
                             const Vec3<T>& r, const T& roughness) {
    const auto map = [&](int layer, const Vec3<T>& d, const T& level) { return maps.environment_maps(d, layer, level); };
    const auto look = [&](int layer, const Vec3<T>& towards) {
        return sample_environment_layer(map, layer, towards, roughness, T(b.environment_levels));
    };
    Vec3<T> radiance = look(0, r);
    const int probes = axes.reflection == SurfaceReflection::none ? 0 : axes.reflection == SurfaceReflection::box ? 1 : 2;
    for (int i = 0; i < probes; ++i) {
        const Vec3<T> low = read<T>(b.reflection_box_min[i]).xyz(), high = read<T>(b.reflection_box_max[i]).xyz();
        const Vec3<T> towards = box_projected_direction(position, r, low, high, read<T>(b.reflection_centre[i]).xyz());
        const T weight = probe_box_weight(position, low, high, T(b.reflection_box_min[i].w));
        radiance = mix(radiance, look(b.reflection_layer[i], towards), weight);
    }
    return radiance;
}

template <class T, class Maps>
Vec3<T> environment_light(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& position,
                          const Vec3<T>& n, const Vec3<T>& v, const SurfaceShading<T>& s, const Vec3<T>& irradiance) {
    const Vec3<T> prefiltered = environment_radiance(axes, b, maps, position, environment_reflection(n, v), s.roughness);
    const auto table = [&](const Vec2<T>& uv) {
        return Vec2<T>{maps.split_sum_table.channel(uv, 0), maps.split_sum_table.channel(uv, 1)};
    };
    const Vec2<T> ab = split_sum_lookup(table, saturate(dot(n, v)), s.roughness, T(b.split_sum_size));
    return image_based_light(s.diffuse, s.specular, irradiance / T(pi), prefiltered, ab);
}

}  // namespace kiln::reference
