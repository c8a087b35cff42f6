#pragma once
// The lecture's reflectance code as printed, as uber/lib/lecture_brdf.glsl names it: in float and half it shows what the
// formulas lose, in double what they mean. Not a reference for anything else.

#include "uber/reference/material_models.h"
#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T ggx_distribution_lecture(const T& NoH, const T& roughness) {
    const T a2 = roughness * roughness;
    const T f = NoH * NoH * (a2 - T(1)) + T(1);
    return a2 / (T(pi) * f * f);
}

template <class T>
T smith_g1_lecture(const T& NdotV, const T& k) {
    return NdotV / (NdotV * (T(1) - k) + k);
}

template <class T>
T smith_lecture(const T& NdotV, const T& NdotL, const T& roughness) {
    const T k = pow(roughness + T(1), T(2)) / T(8);
    return smith_g1_lecture(NdotL, k) * smith_g1_lecture(NdotV, k);
}

template <class T>
T fresnel_schlick_lecture(const T& VoH, const T& f0) {
    const T f = pow(T(1) - VoH, T(5));
    return f0 + (T(1) - f0) * f;
}
template <class T>
Vec3<T> fresnel_schlick_lecture(const T& VoH, const Vec3<T>& f0) {
    return map(f0, [&](const T& c) { return fresnel_schlick_lecture(VoH, c); });
}

template <class T>
Vec3<T> specular_lecture(const T& N_dot_L, const T& N_dot_V, const T& N_dot_H, const T& V_dot_H, const Vec3<T>& F0,
                         const T& roughness) {
    const T D = ggx_distribution_lecture(N_dot_H, roughness);
    const Vec3<T> F = fresnel_schlick_lecture(V_dot_H, F0);
    const T G = smith_lecture(N_dot_V, N_dot_L, roughness);
    return D * F * G / (T(4) * N_dot_V * N_dot_L + T(0.001));
}

template <class T>
Vec3<T> cook_torrance_lecture(const SpecularGlossiness<T>& m, const Vec3<T>& view, const Vec3<T>& light, const T& k_d) {
    const Vec3<T> half_vector = normalize(view + light);
    const T N_dot_L = saturate(dot(m.normal, light)), N_dot_V = abs(dot(m.normal, view));
    const T N_dot_H = saturate(dot(m.normal, half_vector)), V_dot_H = saturate(dot(view, half_vector));
    return k_d * m.diffuse / T(pi) + specular_lecture(N_dot_L, N_dot_V, N_dot_H, V_dot_H, m.specular, T(1) - m.glossiness);
}

template <class T>
SpecularGlossiness<T> metallic_to_specular_lecture(const MetallicRoughness<T>& m, const T& dielectricSpecular) {
    return {mix(splat3(T(0.08) * dielectricSpecular), m.base_color, m.metallic), m.base_color - m.base_color * m.metallic,
            splat3(T(0)), T(1) - m.roughness};
}

// Times I / r^2.
template <class T>
Vec3<T> blinn_phong_lecture(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& kd, const Vec3<T>& ks,
                            const T& p) {
    const Vec3<T> h = normalize(v + l);
    return kd * max(T(0), dot(n, l)) + ks * pow(max(T(0), dot(n, h)), p);
}

}  // namespace kiln::reference
