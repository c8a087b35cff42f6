#ifndef KILN_DISNEY_GLSL
#define KILN_DISNEY_GLSL
// The principled BRDF: Burley, "Physically-Based Shading at Disney", 2012, isotropic, with the BRDF Explorer's disney.brdf
// for what the notes leave open. Parameters are of [0, 1] over their plausible range. It does not conserve energy: the
// diffuse part alone reflects up to 1.38 of what arrives.
#include "fresnel.glsl"
#include "ggx.glsl"
#include "gtr.glsl"
#include "math.glsl"
#include "smith.glsl"
#include "vectors.glsl"

struct DisneyMaterial {
    vec3 base;    // linear
    float metallic, subsurface, specular, roughness, specular_tint, sheen, sheen_tint, clearcoat, clearcoat_gloss;
};

// (1 - c)^5. c: limited to [0, 1] here.
float schlick_weight(float c) {
    const float x = 1.0 - saturate(c);
    const float x2 = x * x;
    return x2 * x2 * x;
}

// The diffuse lobe, with the retro-reflection of rough surfaces at grazing angles; to be multiplied by base / pi:
//   (1 + (F90 - 1) (1 - n.l)^5) (1 + (F90 - 1) (1 - n.v)^5),   F90 = 0.5 + 2 roughness (l.h)^2
// cosines: [0, 1]; roughness: perceptual, [0, 1].
float disney_diffuse(float n_dot_l, float n_dot_v, float l_dot_h, float roughness) {
    const float rise = 2.0 * roughness * l_dot_h * l_dot_h - 0.5;
    return (1.0 + rise * schlick_weight(n_dot_l)) * (1.0 + rise * schlick_weight(n_dot_v));
}

// disney_diffuse renormalised so that it reflects at most what arrives (Lagarde and de Rousiers, "Moving Frostbite to PBR",
// 2014): F90 = 0.5 roughness + 2 roughness (l.h)^2, and a factor from 1 at roughness 0 to 1 / 1.51 at 1. Albedo at most 1
// for n.v from 0.05 on; at roughness 1 it rises to 1.032 as n.v goes to 0.
// cosines: [0, 1]; roughness: perceptual, [0, 1].
float disney_diffuse_renormalised(float n_dot_l, float n_dot_v, float l_dot_h, float roughness) {
    const float rise = roughness * (0.5 + 2.0 * l_dot_h * l_dot_h) - 1.0;
    return (1.0 + rise * schlick_weight(n_dot_l)) * (1.0 + rise * schlick_weight(n_dot_v)) *
           mix(1.0, 1.0 / 1.51, roughness);
}

// The flat lobe that stands for subsurface scattering (after Hanrahan and Krueger); to be multiplied by base / pi:
//   1.25 (F (1 / (n.l + n.v) - 1/2) + 1/2),   F as in disney_diffuse with F90 = roughness (l.h)^2
// n_dot_l, l_dot_h: [0, 1]; n_dot_v: [1e-4, 1]; roughness: perceptual, [0, 1].
float disney_subsurface(float n_dot_l, float n_dot_v, float l_dot_h, float roughness) {
    const float rise = roughness * l_dot_h * l_dot_h - 1.0;
    const float f = (1.0 + rise * schlick_weight(n_dot_l)) * (1.0 + rise * schlick_weight(n_dot_v));
    return 1.25 * (f * (1.0 / (n_dot_l + n_dot_v) - 0.5) + 0.5);
}

// The base's hue at luminance 1; white for black. base: linear, [0, 1].
vec3 disney_tint(vec3 base) {
    const float luminance = dot(base, vec3(0.3, 0.6, 0.1));
    return luminance > 0.0 ? base / max(luminance, 1e-30) : vec3(1.0);
}

// Alpha of the specular lobe: roughness^2, at least 1e-3. roughness: perceptual, limited to [0, 1] here.
float disney_alpha(float roughness) {
    const float r = saturate(roughness);
    return max(r * r, 1e-3);
}

// Alpha of the masking, (0.5 + roughness / 2)^2: less dark than the lobe's own for smooth surfaces.
// roughness: perceptual, limited to [0, 1] here.
float disney_masking_alpha(float roughness) {
    const float r = 0.5 + 0.5 * saturate(roughness);
    return r * r;
}

// The specular lobe D V F(l.h): GTR2, separable Smith at disney_masking_alpha, Schlick to white at grazing.
// n, v, l, h: unit vectors; f0: [0, 1]; roughness: perceptual, [0, 1].
vec3 disney_specular(vec3 n, vec3 h, float n_dot_l, float n_dot_v, float l_dot_h, vec3 f0, float roughness) {
    return ggx_distribution(n, h, disney_alpha(roughness)) *
           visibility_separable(n_dot_l, n_dot_v, disney_masking_alpha(roughness)) *
           mix(f0, vec3(1.0), schlick_weight(l_dot_h));
}

// The clear coat, a quarter of a dielectric of f0 0.04: GTR1 with alpha from 0.1 (satin) to 0.001 (gloss), Smith at 0.25.
// n, h: unit vectors; cosines: [0, 1], n_dot_v: [1e-4, 1]; gloss: limited to [0, 1] here.
float disney_clearcoat(vec3 n, vec3 h, float n_dot_l, float n_dot_v, float l_dot_h, float gloss) {
    return 0.25 * gtr1_distribution(n, h, mix(0.1, 0.001, saturate(gloss))) * visibility_separable(n_dot_l, n_dot_v, 0.25) *
           mix(0.04, 1.0, schlick_weight(l_dot_h));
}

// The whole BRDF times n.l, per steradian. 0 where n.l <= 0; n.v is held at or above 1e-4. Symmetric in v and l.
// n, v, l: unit vectors from the surface; m: every parameter finite, base not negative; the others are limited to [0, 1]
// here.
vec3 disney_brdf(vec3 n, vec3 v, vec3 l, DisneyMaterial m) {
    const vec3 h = safe_normalize(v + l, n);
    const float n_dot_l = saturate(dot(n, l));
    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);
    const float l_dot_h = saturate(dot(l, h));
    const float roughness = saturate(m.roughness);
    const float metallic = saturate(m.metallic);
    const vec3 tint = disney_tint(m.base);
    const vec3 dielectric = 0.08 * saturate(m.specular) * mix(vec3(1.0), tint, saturate(m.specular_tint));
    const vec3 sheen = saturate(m.sheen) * schlick_weight(l_dot_h) * mix(vec3(1.0), tint, saturate(m.sheen_tint));
    const float diffuse = mix(disney_diffuse(n_dot_l, n_dot_v, l_dot_h, roughness),
                              disney_subsurface(n_dot_l, n_dot_v, l_dot_h, roughness), saturate(m.subsurface));
    const vec3 specular =
        disney_specular(n, h, n_dot_l, n_dot_v, l_dot_h, mix(dielectric, m.base, metallic), roughness);
    const float coat =
        saturate(m.clearcoat) * disney_clearcoat(n, h, n_dot_l, n_dot_v, l_dot_h, m.clearcoat_gloss);
    return ((m.base * (diffuse / pi) + sheen) * (1.0 - metallic) + specular + vec3(coat)) * n_dot_l;
}

#endif
