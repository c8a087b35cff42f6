#ifndef KILN_GGX_GLSL
#define KILN_GGX_GLSL
// The GGX microfacet terms. Everywhere alpha = roughness^2 (Burley, "Physically-Based Shading at Disney", 2012);
// `roughness` alone is the perceptual one that artists paint.
#include "math.glsl"

// alpha of a perceptual roughness. Roughness is limited to [0.045, 1]: below it alpha^4 leaves fp32's comfort and a point
// light's highlight its pixel (Filament, brdf.fs).
float ggx_alpha(float roughness) {
    const float r = clamp(roughness, 0.045, 1.0);
    return r * r;
}

// Distribution of visible-side microfacet normals, per steradian (Trowbridge and Reitz 1975; Walter et al. 2007):
//   D = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2)
// Rewritten over d = h - n, because 1 - (n.h)^2 cancels in fp32 (11 % error at roughness 0.045). With c = d.d:
//   n.h = 1 - c/2,   1 - (n.h)^2 = c (1 - c/4),   k = a / (c (1 - c/4) + (a n.h)^2),   D = k^2 / pi
// n, h: unit vectors; alpha: (0, 1].
float ggx_distribution(vec3 n, vec3 h, float alpha) {
    const vec3 d = h - n;
    const float c = dot(d, d);
    const float a_n_dot_h = alpha * (1.0 - 0.5 * c);
    const float k = alpha / (c * (1.0 - 0.25 * c) + a_n_dot_h * a_n_dot_h);
    return k * k / pi;
}

// Height-correlated Smith masking and shadowing over the specular denominator, V = G2 / (4 n.l n.v):
//   V = 0.5 / (n.l sqrt(n.v^2 (1 - a^2) + a^2) + n.v sqrt(n.l^2 (1 - a^2) + a^2))
// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
// n_dot_l: (0, 1]; n_dot_v: [1e-4, 1]; alpha: (0, 1]. Finite for all of these.
float ggx_visibility(float n_dot_l, float n_dot_v, float alpha) {
    const float a2 = alpha * alpha;
    const float v = n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2);
    const float l = n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2);
    return 0.5 / (v + l);
}

#endif
