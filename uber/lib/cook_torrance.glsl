#ifndef KILN_COOK_TORRANCE_GLSL
#define KILN_COOK_TORRANCE_GLSL
// A dielectric or a metal under one light direction: Lambert below a GGX coat.
#include "fresnel.glsl"
#include "ggx.glsl"
#include "vectors.glsl"

// The BRDF times n.l, per steradian:  ((1 - F) diffuse / pi + D V F) n.l,   V = G / (4 n.l n.v) fused.
// What the coat reflects does not reach the base: the diffuse part has the factor 1 - F. 0 where n.l <= 0; n.v is held at
// or above 1e-4, since interpolated normals may turn away from the viewer.
// n, v, l: unit vectors from the surface; diffuse: [0, 1], 0 for a metal; f0: [0, 1]; roughness: perceptual, [0, 1].
vec3 cook_torrance(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0, float roughness) {
    const float n_dot_l = saturate(dot(n, l));
    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);
    const vec3 h = safe_normalize(v + l, n);
    const float alpha = ggx_alpha(roughness);
    const vec3 f = fresnel_schlick(dot(v, h), f0);
    const float specular = ggx_distribution(n, h, alpha) * ggx_visibility(max(n_dot_l, 1e-4), n_dot_v, alpha);
    return ((1.0 - f) * diffuse / pi + specular * f) * n_dot_l;
}

#endif
