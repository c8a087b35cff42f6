#ifndef KILN_COOK_TORRANCE_GLSL
#define KILN_COOK_TORRANCE_GLSL
// A dielectric or a metal under one light direction: Lambert below a GGX coat.
#include "fresnel.glsl"
#include "ggx.glsl"
#include "vectors.glsl"

// The BRDF times n.l, per steradian:
//   ((1 - F(n.l)) (1 - F(n.v)) / (1 - Favg) diffuse / pi + D V F(v.h)) n.l,   V = G / (4 n.l n.v) fused
// Light enters the base and leaves it through the coat: one factor 1 - F a passage, and the division makes up for what the
// first takes on average, so that a white base under a smooth coat reflects exactly all that arrives (Shirley et al., "A
// Practitioners' Assessment of Light Reflection Models", 1997). The common single factor 1 - F(v.h) reflects 55 % more
// than arrives when n.v is 0.1 (f0 0.04). Symmetric in v and l.
// 0 where n.l <= 0; n.v is held at or above 1e-4, since interpolated normals may turn away from the viewer.
// n, v, l: unit vectors from the surface; diffuse: [0, 1], 0 for a metal; f0: [0, 1]; roughness: perceptual, [0, 1].
vec3 cook_torrance(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0, float roughness) {
    const float n_dot_l = saturate(dot(n, l));
    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);
    const vec3 h = safe_normalize(v + l, n);
    const float alpha = ggx_alpha(roughness);
    const vec3 specular = ggx_distribution(n, h, alpha) * ggx_visibility(max(n_dot_l, 1e-4), n_dot_v, alpha) *
                          fresnel_schlick(dot(v, h), f0);
    const vec3 passed = (1.0 - fresnel_schlick(n_dot_l, f0)) * (1.0 - fresnel_schlick(n_dot_v, f0)) /
                        max(1.0 - fresnel_average(f0), vec3(1e-4));
    return (passed * diffuse / pi + specular) * n_dot_l;
}

#endif
