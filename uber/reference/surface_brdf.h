#pragma once
// One light and what a surface reflects of it, as uber/surface_light.glsl and surface_brdf.glsl have them.

#include "uber/reference/blinn_phong_raw.h"
#include "uber/reference/cook_torrance.h"
#include "uber/reference/cook_torrance_forms.h"
#include "uber/reference/disney.h"
#include "uber/reference/lights.h"
#include "uber/reference/surface_material.h"

namespace kiln::reference {

template <class T>
Vec3<T> direction_to_light(const SurfaceAxes& axes, const SurfaceBlocks& b, const Vec3<T>& position) {
    const Vec3<T> to_light =
        axes.light == SurfaceLight::directional ? -read<T>(b.light_direction) : read<T>(b.light_position) - position;
    return safe_normalize(to_light, Vec3<T>{T(0), T(1), T(0)});
}

// On a plane that faces the light, without shadows.
template <class T>
Vec3<T> light_irradiance(const SurfaceAxes& axes, const SurfaceBlocks& b, const Vec3<T>& position, const Vec3<T>& l) {
    if (axes.light == SurfaceLight::directional) return read<T>(b.light_intensity);
    const Vec3<T> to_light = read<T>(b.light_position) - position;
    T share = distance_attenuation(dot(to_light, to_light), T(b.light_range));
    if (axes.light == SurfaceLight::spot)
        share = share * cone_attenuation(dot(-l, read<T>(b.light_direction)), T(b.light_cos_inner), T(b.light_cos_outer));
    return read<T>(b.light_intensity) * share;
}

// Times n.l.
template <class T>
Vec3<T> reflected_light(const SurfaceAxes& axes, const SurfaceBlocks& b, const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l,
                        const SurfaceShading<T>& s) {
    const T shininess(b.shininess);
    switch (axes.material) {
        case SurfaceMaterial::blinn_phong:
            return blinn_phong(n, v, l, s.diffuse, s.specular, shininess);
        case SurfaceMaterial::blinn_phong_raw:
            return blinn_phong_raw(n, v, l, s.diffuse, s.specular, shininess);
        case SurfaceMaterial::blinn_phong_lecture:
            return blinn_phong_lecture(n, v, l, s.diffuse, s.specular, shininess);
        case SurfaceMaterial::pbr_lecture:
            return cook_torrance_lecture(SpecularGlossiness<T>{s.specular, s.diffuse, n, T(1) - s.roughness}, v, l, T(1)) *
                   saturate(dot(n, l));
        case SurfaceMaterial::disney: {
            DisneyMaterial<T> m;
            m.base = s.base;
            m.metallic = s.metallic;
            m.subsurface = T(b.disney_subsurface_share);
            m.specular = T(b.disney_specular_level);
            m.roughness = s.roughness;
            m.specular_tint = T(b.disney_specular_tint);
            m.sheen = T(b.disney_sheen);
            m.sheen_tint = T(b.disney_sheen_tint);
            m.clearcoat = T(b.disney_coat);
            m.clearcoat_gloss = T(b.disney_coat_gloss);
            return disney_brdf(n, v, l, m);
        }
        default:
            return axes.hammon ? cook_torrance_hammon(n, v, l, s.diffuse, s.specular, s.roughness)
                               : cook_torrance(n, v, l, s.diffuse, s.specular, s.roughness);
    }
}

}  // namespace kiln::reference
