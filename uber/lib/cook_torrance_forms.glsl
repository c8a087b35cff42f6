#ifndef KILN_COOK_TORRANCE_FORMS_GLSL
#define KILN_COOK_TORRANCE_FORMS_GLSL
// cook_torrance.glsl for slow machines.
#include "fresnel.glsl"
#include "ggx.glsl"
#include "smith.glsl"
#include "vectors.glsl"

// The same with Hammon's masking, which has no roots (smith.glsl), and one factor 1 - Favg for what the coat lets through, which
// has no view or light in it and so needs no further Fresnel terms:  ((1 - Favg) diffuse / pi + D V F(v.h)) n.l.
// Symmetric in v and l; a white base reflects less than arrives, by up to Favg where the coat itself reflects little.
// n, v, l: unit vectors from the surface; diffuse: [0, 1], 0 for a metal; f0: [0, 1]; roughness: perceptual, [0, 1].
vec3 cook_torrance_hammon(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0, float roughness) {
    const float n_dot_l = saturate(dot(n, l));
    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);
    const vec3 h = safe_normalize(v + l, n);
    const float alpha = ggx_alpha(roughness);
    const vec3 specular = ggx_distribution(n, h, alpha) * visibility_hammon(max(n_dot_l, 1e-4), n_dot_v, alpha) *
                          fresnel_schlick(dot(v, h), f0);
    return ((1.0 - fresnel_average(f0)) * diffuse / pi + specular) * n_dot_l;
}

#endif
