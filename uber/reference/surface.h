#pragma once
// uber/surface.* as a function: axes, blocks, textures and interpolated inputs to what each pass writes, composed of the
// references of its systems. Textures are callables of `Maps`, by the shader's names.

#include "uber/reference/blinn_phong.h"
#include "uber/reference/cook_torrance.h"
#include "uber/reference/lights.h"
#include "uber/reference/materials.h"
#include "uber/reference/motion.h"
#include "uber/reference/octahedral.h"
#include "uber/reference/sh_lightmap.h"
#include "uber/reference/shadow_map.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

enum class SurfaceLight { none, directional, point, spot };
enum class SurfaceMaterial { blinn_phong, pbr_mr, pbr_sg };
enum class SurfaceLightmap { none, flat, sh_lq, sh_hq };

struct SurfaceAxes {
    SurfaceLight light = SurfaceLight::none;
    SurfaceMaterial material = SurfaceMaterial::blinn_phong;
    SurfaceLightmap lightmap = SurfaceLightmap::none;
    bool two_sided = false;
    bool shadow = false;
};

// The shader's blocks (surface_interface.glsl). Every number is one of fp32, since that is what the device reads.
struct SurfaceBlocks {
    Mat4<double> view_projection, previous_view_projection;
    Vec4<double> jitter;
    Vec3<double> camera_position, ambient_irradiance;
    Vec3<double> light_position, light_direction, light_intensity;
    double light_range = 1, light_cos_inner = 1, light_cos_outer = 0;
    Mat4<double> shadow_view_projection;
    double shadow_near = 1, shadow_far = 2, shadow_texel = 0, shadow_depth_bias = 0;
    Vec4<double> base_factor, specular_factor;
    Vec3<double> emissive;
    double dielectric_specular = 0.5, shininess = 1, roughness_factor = 1, metallic_factor = 1, glossiness_factor = 1;
    Mat4<double> model, previous_model;
    Vec4<double> lightmap_rect;
    double lightmap_range = 1;
};

template <class T>
Vec3<T> read(const Vec3<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
Vec4<T> read(const Vec4<double>& v) {
    return {T(v.x), T(v.y), T(v.z), T(v.w)};
}
template <class T>
Mat4<T> read(const Mat4<double>& m) {
    return {{read<T>(m.columns[0]), read<T>(m.columns[1]), read<T>(m.columns[2]), read<T>(m.columns[3])}};
}

// ---- vertex stage ----

template <class T>
struct SurfaceVaryings {
    Vec3<T> world_position, world_normal;
    Vec2<T> material_uv, atlas_uv;
    Vec4<T> clip_position, previous_clip_position;
};

template <class T>
SurfaceVaryings<T> surface_vertex(const SurfaceBlocks& b, const Vec3<T>& position, const Vec3<T>& normal, const Vec2<T>& uv,
                                  const Vec2<T>& lightmap_uv) {
    const Vec4<T> at{position.x, position.y, position.z, T(1)};
    const Mat4<T> model = read<T>(b.model);
    const Vec4<T> world = model * at, rect = read<T>(b.lightmap_rect);
    SurfaceVaryings<T> out;
    out.clip_position = read<T>(b.view_projection) * world;
    out.previous_clip_position = read<T>(b.previous_view_projection) * (read<T>(b.previous_model) * at);
    out.world_position = world.xyz();
    const Mat3<T> upper{{model.columns[0].xyz(), model.columns[1].xyz(), model.columns[2].xyz()}};
    out.world_normal = transform_normal(upper, normal);
    out.material_uv = uv;
    out.atlas_uv = lightmap_uv * rect.xy() + Vec2<T>{rect.z, rect.w};
    return out;
}

// ---- fragment stage ----

template <class T>
struct SurfaceShading {
    Vec3<T> diffuse, specular;
    T roughness{};
};

template <class T, class Maps>
SurfaceShading<T> surface_material(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec2<T>& uv) {
    SurfaceShading<T> s;
    const Vec3<T> base = reflectance(maps.base_map.rgb(uv), read<T>(b.base_factor).xyz());
    if (axes.material == SurfaceMaterial::pbr_mr) {
        const T metallic = maps.metallic_map.channel(uv, 0) * T(b.metallic_factor);
        s.diffuse = metallic_diffuse(base, metallic);
        s.specular = metallic_f0(base, metallic, T(b.dielectric_specular));
        s.roughness = saturate(maps.roughness_map.channel(uv, 0) * T(b.roughness_factor));
        return s;
    }
    s.diffuse = base;
    s.specular = reflectance(maps.specular_map.rgb(uv), read<T>(b.specular_factor).xyz());
    s.roughness = axes.material == SurfaceMaterial::pbr_sg
                      ? T(1) - saturate(maps.gloss_map.channel(uv, 0) * T(b.glossiness_factor))
                      : blinn_phong_roughness(clamp(T(b.shininess), T(1), T(2048)));
    return s;
}

template <class T, class Maps>
Vec3<T> surface_irradiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec2<T>& uv,
                           const Vec3<T>& n) {
    const T range(b.lightmap_range);
    if (axes.lightmap == SurfaceLightmap::none) return read<T>(b.ambient_irradiance);
    if (axes.lightmap == SurfaceLightmap::flat) return decode_flat_lightmap(maps.lightmap_flat.rgb(uv), range);
    return sh_l1_irradiance(maps.lightmap_l0.rgb(uv) * range, decode_sh_ratio(maps.lightmap_l1_y.rgb(uv)),
                            decode_sh_ratio(maps.lightmap_l1_z.rgb(uv)), decode_sh_ratio(maps.lightmap_l1_x.rgb(uv)), n);
}

template <class T>
Vec3<T> surface_normal(const SurfaceAxes& axes, const Vec3<T>& world_normal, bool front) {
    const Vec3<T> n = safe_normalize(world_normal, Vec3<T>{T(0), T(0), T(1)});
    return axes.two_sided && !front ? -n : n;
}

// Light that no lamp of the frame sends: what other surfaces and the sky send, and the surface's own.
template <class T, class Maps>
Vec3<T> surface_unlit(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                      const SurfaceShading<T>& s, const Vec3<T>& n) {
    return s.diffuse / T(pi) * surface_irradiance(axes, b, maps, in.atlas_uv, n) + read<T>(b.emissive);
}

template <class T, class Maps>
T surface_visibility(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& at, const Vec3<T>& n,
                     const Vec3<T>& l) {
    if (!axes.shadow) return T(1);
    if (axes.light == SurfaceLight::point) {
        const Vec3<T> light = read<T>(b.light_position);
        const T away = max_component(map(at - light, [](const T& x) { return abs(x); }));
        const Vec3<T> receiver = offset_shadow_receiver(at, n, dot(n, l), T(b.shadow_texel) * away);
        return shadow_factor_cube(maps.shadow_cube, receiver - light, T(b.shadow_near), T(b.shadow_far), T(b.shadow_depth_bias));
    }
    const Mat4<T> matrix = read<T>(b.shadow_view_projection);
    const T w = (matrix * Vec4<T>{at.x, at.y, at.z, T(1)}).w;
    const Vec3<T> r = offset_shadow_receiver(at, n, dot(n, l), T(b.shadow_texel) * max(w, T(0)));
    const auto compare = [&](const Vec2<T>& uv, const T& depth) { return maps.shadow(uv, depth); };
    return shadow_factor_2d(compare, matrix * Vec4<T>{r.x, r.y, r.z, T(1)}, T(b.shadow_depth_bias));
}

// Radiance that the frame's lamp sends to the eye by way of the surface.
template <class T, class Maps>
Vec3<T> surface_lit(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec3<T>& at,
                    const SurfaceShading<T>& s, const Vec3<T>& n) {
    if (axes.light == SurfaceLight::none) return splat3(T(0));
    const Vec3<T> v = safe_normalize(read<T>(b.camera_position) - at, n), direction = read<T>(b.light_direction);
    const Vec3<T> to_light = axes.light == SurfaceLight::directional ? -direction : read<T>(b.light_position) - at;
    const Vec3<T> l = safe_normalize(to_light, Vec3<T>{T(0), T(1), T(0)});
    const Vec3<T> reflected = axes.material == SurfaceMaterial::blinn_phong
                                  ? blinn_phong(n, v, l, s.diffuse, s.specular, T(b.shininess))
                                  : cook_torrance(n, v, l, s.diffuse, s.specular, s.roughness);
    T share(1);
    if (axes.light != SurfaceLight::directional) share = distance_attenuation(dot(to_light, to_light), T(b.light_range));
    if (axes.light == SurfaceLight::spot)
        share = share * cone_attenuation(dot(-l, direction), T(b.light_cos_inner), T(b.light_cos_outer));
    return reflected * read<T>(b.light_intensity) * (share * surface_visibility(axes, b, maps, at, n, l));
}

template <class T, class Maps>
Vec3<T> surface_radiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                         bool front) {
    const Vec3<T> n = surface_normal(axes, in.world_normal, front);
    const SurfaceShading<T> s = surface_material(axes, b, maps, in.material_uv);
    return surface_unlit(axes, b, maps, in, s, n) + surface_lit(axes, b, maps, in.world_position, s, n);
}

template <class T>
struct SurfaceGbuffer {
    Vec4<T> diffuse, specular;
    Vec2<T> normal;
    Vec4<T> radiance;
};

template <class T, class Maps>
SurfaceGbuffer<T> surface_gbuffer(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                                  bool front) {
    const Vec3<T> n = surface_normal(axes, in.world_normal, front);
    const SurfaceShading<T> s = surface_material(axes, b, maps, in.material_uv);
    const Vec3<T> unlit = surface_unlit(axes, b, maps, in, s, n);
    const T model(axes.material == SurfaceMaterial::blinn_phong ? 0 : 1);
    return {{s.diffuse.x, s.diffuse.y, s.diffuse.z, model},
            {s.specular.x, s.specular.y, s.specular.z, s.roughness},
            encode_octahedral(n),
            {unlit.x, unlit.y, unlit.z, T(axes.lightmap == SurfaceLightmap::none ? 0 : 1)}};
}

template <class T>
Vec2<T> surface_velocity(const SurfaceBlocks& b, const SurfaceVaryings<T>& in) {
    return screen_motion(in.clip_position, in.previous_clip_position, read<T>(b.jitter));
}

}  // namespace kiln::reference
