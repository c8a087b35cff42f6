#ifndef KILN_COOK_TORRANCE_GLSL
#define KILN_COOK_TORRANCE_GLSL
// A dielectric or a metal under one light direction: Lambert below a GGX coat.
#include "fresnel.glsl"
#include "ggx.glsl"
#include "vectors.glsl"

// By how much of F90 a rough coat reflects more than F(n.v), a smooth one's reflectance, which the base below is dimmed by: half
// vectors tilt both ways and F is convex, so that its mean over them is more than F at their middle. By quadrature 0.0018 at most,
// at roughness 0.325 and n.v 0.6 of F0 = 0.02; from roughness 0.5 on masking takes more. A bound of the form
// k alpha (1 - alpha)^2 over all n.v, F0 and alpha: the least k is 0.0267, rounded up here. 0 for a smooth coat. alpha: [0, 1].
float rough_coat_surplus(float alpha) {
    const float flat_share = 1.0 - alpha;
    return 0.028 * alpha * flat_share * flat_share;
}

// The BRDF times n.l, per steradian, with s the surplus above:
//   ((1 - F(n.l)) (1 - F(n.v)) / (1 - Favg) (1 - s F90) diffuse / pi + D V F(v.h)) n.l,   V = G / (4 n.l n.v) fused
// Light enters the base and leaves it through the coat: one factor 1 - F a passage, and the division makes up for what the
// first takes on average, so that a white base under a smooth coat reflects exactly all that arrives, under a rough one no
// more (Shirley et al., "A Practitioners' Assessment of Light Reflection Models", 1997). The common single factor 1 - F(v.h) reflects 55 % more
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
                        max(1.0 - fresnel_average(f0), vec3(1e-4)) * (1.0 - rough_coat_surplus(alpha) * fresnel_f90(f0));
    return (passed * diffuse / pi + specular) * n_dot_l;
}

#endif
