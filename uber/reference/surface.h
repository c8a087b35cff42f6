#pragma once
// uber/surface.* as a function: axes, blocks, textures and interpolated inputs to what each pass writes, composed of the
// references of its systems. Textures are callables of `Maps`, by the shader's names.

#include "uber/reference/motion.h"
#include "uber/reference/octahedral.h"
#include "uber/reference/surface_brdf.h"
#include "uber/reference/surface_indirect.h"
#include "uber/reference/surface_shadow.h"

namespace kiln::reference {

// ---- vertex stage ----

template <class T>
struct SurfaceVertex {
    Vec3<T> position, normal;
    Vec2<T> uv, lightmap_uv;
    Vec4<T> tangent;
};

template <class T>
SurfaceVaryings<T> surface_vertex(const SurfaceBlocks& b, const SurfaceVertex<T>& v) {
    const Vec4<T> at{v.position.x, v.position.y, v.position.z, T(1)};
    const Mat4<T> model = read<T>(b.model);
    const Vec4<T> world = model * at, rect = read<T>(b.lightmap_rect);
    SurfaceVaryings<T> out;
    out.clip_position = read<T>(b.view_projection) * world;
    out.previous_clip_position = read<T>(b.previous_view_projection) * (read<T>(b.previous_model) * at);
    out.world_position = world.xyz();
    const Mat3<T> upper{{model.columns[0].xyz(), model.columns[1].xyz(), model.columns[2].xyz()}};
    out.world_normal = transform_normal(upper, v.normal);
    const Vec3<T> tangent = upper * v.tangent.xyz();
    out.world_tangent = {tangent.x, tangent.y, tangent.z, v.tangent.w};
    out.material_uv = v.uv;
    out.atlas_uv = v.lightmap_uv * rect.xy() + Vec2<T>{rect.z, rect.w};
    return out;
}

// ---- fragment stage ----

template <class T, class Maps>
Vec3<T> surface_radiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                         bool front) {
    const Vec3<T> n = surface_normal(axes, maps, in, front);
    const SurfaceShading<T> s = surface_material(axes, b, maps, in.material_uv);
    const Vec3<T> v = safe_normalize(read<T>(b.camera_position) - in.world_position, n);
    Vec3<T> radiance = splat3(T(0));
    if (!axes.additive) {
        const Vec3<T> irradiance = surface_irradiance(axes, b, maps, in, n), emissive = read<T>(b.emissive);
        radiance = axes.ibl ? environment_light(axes, b, maps, in.world_position, n, v, s, irradiance) + emissive
                            : surface_diffuse(axes, s, irradiance) + emissive;
        radiance = relaxed(axes, radiance);
    }
    if (axes.light == SurfaceLight::none) return radiance;
    const Vec3<T> l = direction_to_light(axes, b, in.world_position);
    const Vec3<T> reflected = relaxed(axes, reflected_light(axes, b, n, v, l, s));
    const Vec3<T> arriving = light_irradiance(axes, b, in.world_position, l);
    const T visible = light_visibility(axes, b, maps, in.world_position, geometric_normal(axes, in, front), l);
    return relaxed(axes, radiance + relaxed(axes, relaxed(axes, reflected * arriving) * visible));
}

template <class T>
struct SurfaceGbuffer {
    Vec4<T> diffuse, specular, normal, irradiance, radiance;
};

template <class T, class Maps>
SurfaceGbuffer<T> surface_gbuffer(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const SurfaceVaryings<T>& in,
                                  bool front) {
    const Vec3<T> n = surface_normal(axes, maps, in, front);
    const SurfaceShading<T> s = surface_material(axes, b, maps, in.material_uv);
    const Vec3<T> irradiance = surface_irradiance(axes, b, maps, in, n) / T(pi), emissive = read<T>(b.emissive);
    const Vec2<T> shading = encode_octahedral(n), geometric = encode_octahedral(geometric_normal(axes, in, front));
    const bool baked = axes.lightmap != SurfaceLightmap::none || axes.probes != SurfaceProbes::none;
    const T model(axes.material == SurfaceMaterial::blinn_phong ? 0 : 1);
    return {{s.diffuse.x, s.diffuse.y, s.diffuse.z, model},
            {s.specular.x, s.specular.y, s.specular.z, s.roughness},
            {shading.x, shading.y, geometric.x, geometric.y},
            {irradiance.x, irradiance.y, irradiance.z, T(baked ? 1 : 0)},
            {emissive.x, emissive.y, emissive.z, T(1)}};
}

template <class T>
Vec2<T> surface_velocity(const SurfaceBlocks& b, const SurfaceVaryings<T>& in) {
    return screen_motion(in.clip_position, in.previous_clip_position, read<T>(b.jitter));
}

}  // namespace kiln::reference
