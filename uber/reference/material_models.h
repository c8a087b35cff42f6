#pragma once
// Metallic-roughness and specular-glossiness, as uber/lib/material_models.glsl names them.

#include "uber/reference/materials.h"

namespace kiln::reference {

template <class T>
struct MetallicRoughness {
    Vec3<T> base_color, normal;
    T roughness{}, metallic{};
};

template <class T>
struct SpecularGlossiness {
    Vec3<T> specular, diffuse, normal;
    T glossiness{};
};

template <class T>
SpecularGlossiness<T> metallic_to_specular(const MetallicRoughness<T>& m, const T& dielectric_specular) {
    const Vec3<T> base = saturate(m.base_color);
    return {metallic_f0(base, m.metallic, dielectric_specular), metallic_diffuse(base, m.metallic), m.normal,
            T(1) - saturate(m.roughness)};
}

template <class T>
SpecularGlossiness<T> metallic_to_specular_pushed(const MetallicRoughness<T>& m, const T& dielectric_specular) {
    const Vec3<T> none = splat3(T(0));
    return {max(mix(splat3(T(0.08) * dielectric_specular), m.base_color, m.metallic), none),
            max(m.base_color * (T(1) - m.metallic), none), m.normal, T(1) - m.roughness};
}

template <class T>
T ggx_alpha_pushed(const T& roughness) {
    const T r = clamp(roughness, T(0.045), T(4));
    return r * r;
}

}  // namespace kiln::reference
