#ifndef KILN_SMITH_GLSL
#define KILN_SMITH_GLSL
// Smith's masking for GGX, and the visibility terms that stand in for it, all as V = G / (4 n.l n.v): fused, so that no
// denominator has to be padded against 0. The exact one is ggx_visibility of ggx.glsl. Cosines are of n with l or v; where not
// said otherwise n_dot_l: (0, 1], n_dot_v: [1e-4, 1].
#include "math.glsl"

// sqrt(c^2 + a^2 (1 - c^2)), without cancellation for any alpha, also above 1. c: [0, 1]; alpha: (0, 16].
float smith_root(float c, float alpha) {
    return sqrt(c * c + alpha * alpha * ((1.0 - c) * (1.0 + c)));
}

// Smith's Lambda = (sqrt(1 + a^2 tan^2) - 1) / 2 (Heitz 2014), multiplied out over its conjugate, since the difference is
// 0 already at alpha 2e-4, and over c, so that tan^2 cannot overflow:
//   Lambda = a^2 (1 - c^2) / (2 c (c + sqrt(c^2 + a^2 (1 - c^2))))
// c: [1e-18, 1]; alpha: [1e-4, 16].
float smith_lambda(float c, float alpha) {
    return alpha * alpha * ((1.0 - c) * (1.0 + c)) / (2.0 * c * (c + smith_root(c, alpha)));
}

// The visible part of the microfacets seen under c:  G1 = 1 / (1 + Lambda) = 2 c / (c + root). c: [0, 1], alpha: [1e-4, 16].
float smith_g1(float c, float alpha) {
    return 2.0 * c / (c + smith_root(c, alpha));
}

// Masking and shadowing as independent, the exact G1(l) G1(v); too dark where both are grazing. alpha: [2e-3, 16].
float visibility_separable(float n_dot_l, float n_dot_v, float alpha) {
    return 1.0 / ((n_dot_l + smith_root(n_dot_l, alpha)) * (n_dot_v + smith_root(n_dot_v, alpha)));
}

// The height-correlated ggx_visibility for an alpha that may have been pushed above 1: the roots keep positive terms only.
// n_dot_l: [1e-4, 1]; alpha: [2e-3, 16].
float visibility_height_correlated_pushed(float n_dot_l, float n_dot_v, float alpha) {
    return 0.5 / (n_dot_l * smith_root(n_dot_v, alpha) + n_dot_v * smith_root(n_dot_l, alpha));
}

// Separable with Schlick's G1 = c / (c (1 - k) + k), as a V. k: (0, 1].
float visibility_schlick(float n_dot_l, float n_dot_v, float k) {
    return 0.25 / ((n_dot_l * (1.0 - k) + k) * (n_dot_v * (1.0 - k) + k));
}

// Karis 2013 for image-based light: k = alpha / 2. The exact G1 at alpha = 1. alpha: [2e-3, 1].
float visibility_karis_ibl(float n_dot_l, float n_dot_v, float alpha) {
    return visibility_schlick(n_dot_l, n_dot_v, 0.5 * alpha);
}

// Karis 2013 for analytic lights only: k = (roughness + 1)^2 / 8, "hotness" lowered by taste; far too dark in an integral
// over the hemisphere. roughness: perceptual, [0, 1].
float visibility_karis_direct(float n_dot_l, float n_dot_v, float roughness) {
    const float r = roughness + 1.0;
    return visibility_schlick(n_dot_l, n_dot_v, 0.125 * r * r);
}

// A fit of the height-correlated form without roots, 0.5 / mix(2 n.l n.v, n.l + n.v, alpha). Hammon, "PBR Diffuse Lighting
// for GGX+Smith Microsurfaces", GDC 2017. n_dot_l: [1e-4, 1]; alpha: [0, 1].
float visibility_hammon(float n_dot_l, float n_dot_v, float alpha) {
    return 0.5 / mix(2.0 * n_dot_l * n_dot_v, n_dot_l + n_dot_v, alpha);
}

// V = 1 / (4 (v.h)^2), whatever the roughness. Kelemen and Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF
// Model with Importance Sampling", 2001. v_dot_h: held at or above 1e-4 here.
float visibility_kelemen(float v_dot_h) {
    const float c = max(v_dot_h, 1e-4);
    return 0.25 / (c * c);
}

// G = n.l n.v: neither roots nor arguments.
float visibility_implicit() { return 0.25; }

#endif
