#pragma once
// The principled BRDF of Burley 2012, as uber/lib/disney.glsl names its parts.

#include "uber/reference/ggx_forms.h"
#include "uber/reference/gtr.h"
#include "uber/reference/numbers.h"
#include "uber/reference/smith.h"

namespace kiln::reference {

template <class T>
struct DisneyMaterial {
    Vec3<T> base;
    T metallic{}, subsurface{}, specular{}, roughness{}, specular_tint{}, sheen{}, sheen_tint{}, clearcoat{}, clearcoat_gloss{};
};

template <class T>
T schlick_weight(const T& c) {
    const T x = T(1) - saturate(c);
    return x * x * x * x * x;
}

// Schlick's weight twice, from 1 at normal incidence to f90 at grazing.
template <class T>
T disney_lobe(const T& n_dot_l, const T& n_dot_v, const T& f90) {
    return (T(1) + (f90 - T(1)) * schlick_weight(n_dot_l)) * (T(1) + (f90 - T(1)) * schlick_weight(n_dot_v));
}

template <class T>
T disney_diffuse(const T& n_dot_l, const T& n_dot_v, const T& l_dot_h, const T& roughness) {
    return disney_lobe(n_dot_l, n_dot_v, T(0.5) + T(2) * roughness * l_dot_h * l_dot_h);
}

template <class T>
T disney_diffuse_renormalised(const T& n_dot_l, const T& n_dot_v, const T& l_dot_h, const T& roughness) {
    const T f90 = T(0.5) * roughness + T(2) * roughness * l_dot_h * l_dot_h;
    return disney_lobe(n_dot_l, n_dot_v, f90) * mix(T(1), T(1 / 1.51), roughness);
}

template <class T>
T disney_subsurface(const T& n_dot_l, const T& n_dot_v, const T& l_dot_h, const T& roughness) {
    const T f = disney_lobe(n_dot_l, n_dot_v, roughness * l_dot_h * l_dot_h);
    return T(1.25) * (f * (T(1) / (n_dot_l + n_dot_v) - T(0.5)) + T(0.5));
}

template <class T>
Vec3<T> disney_tint(const Vec3<T>& base) {
    const T luminance = dot(base, Vec3<T>{T(0.3), T(0.6), T(0.1)});
    return value(luminance) > 0 ? base / max(luminance, T(1e-30)) : splat3(T(1));
}

template <class T>
T disney_alpha(const T& roughness) {
    const T r = saturate(roughness);
    return max(r * r, T(1e-3));
}

template <class T>
T disney_masking_alpha(const T& roughness) {
    const T r = T(0.5) + T(0.5) * saturate(roughness);
    return r * r;
}

template <class T>
Vec3<T> disney_specular(const Vec3<T>& n, const Vec3<T>& h, const T& n_dot_l, const T& n_dot_v, const T& l_dot_h,
                        const Vec3<T>& f0, const T& roughness) {
    const Vec3<T> d = h - n;
    const T c = dot(d, d);
    const T lobe = ggx_from_sine(T(1) - T(0.5) * c, c * (T(1) - T(0.25) * c), disney_alpha(roughness));
    const T visibility = visibility_separable(n_dot_l, n_dot_v, disney_masking_alpha(roughness));
    return mix(f0, splat3(T(1)), schlick_weight(l_dot_h)) * (lobe * visibility);
}

template <class T>
T disney_clearcoat(const Vec3<T>& n, const Vec3<T>& h, const T& n_dot_l, const T& n_dot_v, const T& l_dot_h, const T& gloss) {
    return T(0.25) * gtr1_distribution(n, h, mix(T(0.1), T(0.001), saturate(gloss))) *
           visibility_separable(n_dot_l, n_dot_v, T(0.25)) * mix(T(0.04), T(1), schlick_weight(l_dot_h));
}

// Times n.l.
template <class T>
Vec3<T> disney_brdf(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const DisneyMaterial<T>& m) {
    const Vec3<T> sum = v + l;
    const Vec3<T> h = value(dot(sum, sum)) > 0 ? normalize(sum) : n;
    const T n_dot_l = saturate(dot(n, l)), n_dot_v = clamp(dot(n, v), T(1e-4), T(1)), l_dot_h = saturate(dot(l, h));
    const T roughness = saturate(m.roughness), metallic = saturate(m.metallic);
    const Vec3<T> white = splat3(T(1)), tint = disney_tint(m.base);
    const Vec3<T> dielectric = mix(white, tint, saturate(m.specular_tint)) * (T(0.08) * saturate(m.specular));
    const Vec3<T> sheen = mix(white, tint, saturate(m.sheen_tint)) * (saturate(m.sheen) * schlick_weight(l_dot_h));
    const T diffuse = mix(disney_diffuse(n_dot_l, n_dot_v, l_dot_h, roughness),
                          disney_subsurface(n_dot_l, n_dot_v, l_dot_h, roughness), saturate(m.subsurface));
    const Vec3<T> specular = disney_specular(n, h, n_dot_l, n_dot_v, l_dot_h, mix(dielectric, m.base, metallic), roughness);
    const T coat = saturate(m.clearcoat) * disney_clearcoat(n, h, n_dot_l, n_dot_v, l_dot_h, m.clearcoat_gloss);
    return ((m.base * (diffuse / T(pi)) + sheen) * (T(1) - metallic) + specular + splat3(coat)) * n_dot_l;
}

}  // namespace kiln::reference
