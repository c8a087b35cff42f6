#pragma once
// What a surface is, sampled once, as uber/surface_material.glsl has it.

#include "uber/reference/blinn_phong.h"
#include "uber/reference/lecture_brdf.h"
#include "uber/reference/materials.h"
#include "uber/reference/normal_map.h"
#include "uber/reference/surface_blocks.h"

namespace kiln::reference {

template <class T>
struct SurfaceShading {
    Vec3<T> diffuse, specular, base;
    T roughness{}, metallic{};
};

template <class T, class Maps>
SurfaceShading<T> surface_material(const SurfaceAxes& axes, const SurfaceBlocks& b, const Maps& maps, const Vec2<T>& uv) {
    SurfaceShading<T> s;
    s.base = relaxed(axes, reflectance(maps.base_map.rgb(uv), read<T>(b.base_factor).xyz()));
    s.diffuse = s.base;
    switch (axes.material) {
        case SurfaceMaterial::pbr_mr:
        case SurfaceMaterial::disney:
        case SurfaceMaterial::pbr_lecture: {
            const T metallic = relaxed(axes, maps.metallic_map.channel(uv, 0) * T(b.metallic_factor));
            s.metallic = saturate(metallic);
            s.roughness = relaxed(axes, saturate(maps.roughness_map.channel(uv, 0) * T(b.roughness_factor)));
            if (axes.material == SurfaceMaterial::pbr_lecture) {
                const SpecularGlossiness<T> converted = metallic_to_specular_lecture(
                    MetallicRoughness<T>{s.base, splat3(T(0)), s.roughness, metallic}, T(b.dielectric_specular));
                s.diffuse = converted.diffuse;
                s.specular = converted.specular;
            } else {
                s.diffuse = relaxed(axes, metallic_diffuse(s.base, metallic));
                s.specular = relaxed(axes, metallic_f0(s.base, metallic, T(b.dielectric_specular)));
            }
            return s;
        }
        default:
            break;
    }
    s.specular = relaxed(axes, reflectance(maps.specular_map.rgb(uv), read<T>(b.specular_factor).xyz()));
    s.roughness = axes.material == SurfaceMaterial::pbr_sg
                      ? T(1) - saturate(maps.gloss_map.channel(uv, 0) * T(b.glossiness_factor))
                  : axes.material == SurfaceMaterial::blinn_phong ? blinn_phong_roughness(clamp(T(b.shininess), T(1), T(2048)))
                                                                  : T(1);
    s.roughness = relaxed(axes, s.roughness);
    return s;
}

// Without the normal map.
template <class T>
Vec3<T> geometric_normal(const SurfaceAxes& axes, const SurfaceVaryings<T>& in, bool front) {
    const Vec3<T> n = safe_normalize(in.world_normal, Vec3<T>{T(0), T(0), T(1)});
    return axes.two_sided && !front ? -n : n;
}

template <class T, class Maps>
Vec3<T> surface_normal(const SurfaceAxes& axes, const Maps& maps, const SurfaceVaryings<T>& in, bool front) {
    if (!axes.normal_map) return geometric_normal(axes, in, front);
    const Vec3<T> n = safe_normalize(in.world_normal, Vec3<T>{T(0), T(0), T(1)});
    const Vec3<T> mapped = apply_normal(tangent_frame(n, in.world_tangent.xyz(), in.world_tangent.w),
                                        decode_normal_unorm8(maps.normal_map.rgb(in.material_uv)));
    return axes.two_sided && !front ? -mapped : mapped;
}

}  // namespace kiln::reference
