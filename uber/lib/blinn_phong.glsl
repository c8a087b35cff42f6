#ifndef KILN_BLINN_PHONG_GLSL
#define KILN_BLINN_PHONG_GLSL
// Blinn-Phong that does not make energy.
#include "math.glsl"
#include "vectors.glsl"

// The factor c that makes c (n.h)^p reflect exactly 1 at normal incidence:
//   integral of (n.h)^p n.l over the hemisphere at v = n is 8 pi (2^(-p/2) + p) / ((p + 2)(p + 4)), and c its inverse.
// Giesen, "Phong and Blinn-Phong Normalization Factors", 2009. The usual (p + 8) / (8 pi) is its fit for large p and
// 7 % too bright at p = 10. shininess: [1, 2048].
float blinn_phong_normalization(float shininess) {
    return (shininess + 2.0) * (shininess + 4.0) / (8.0 * pi * (exp2(-0.5 * shininess) + shininess));
}

// The perceptual roughness whose GGX lobe is as wide: alpha = sqrt(2 / (p + 2)) (Walter et al. 2007), roughness its root.
// shininess: [1, 2048]. Returns values in (0, 1).
float blinn_phong_roughness(float shininess) {
    return sqrt(sqrt(2.0 / (shininess + 2.0)));
}

// The way back, p = 2 / roughness^4 - 2, limited to [1, 2048]. roughness: [0, 1].
float blinn_phong_shininess(float roughness) {
    const float r2 = roughness * roughness;
    return clamp(2.0 / max(r2 * r2, 1e-6) - 2.0, 1.0, 2048.0);
}

// The BRDF times n.l, per steradian:  (kd (1 - max ks) / pi + ks c (n.h)^p) n.l.  The highlight has the gate n.l > 0 like
// the diffuse part (without it light leaks through from behind), and what it reflects is taken from the diffuse part.
// n, v, l: unit vectors from the surface; diffuse (kd), specular (ks): [0, 1]; shininess: limited to [1, 2048] here, so
// that pow never sees 0^0 and log2 near 1 stays exact enough.
vec3 blinn_phong(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 specular, float shininess) {
    const float n_dot_l = saturate(dot(n, l));
    const vec3 h = safe_normalize(v + l, n);
    const float p = clamp(shininess, 1.0, 2048.0);
    const float lobe = blinn_phong_normalization(p) * pow(saturate(dot(n, h)), p);
    return (diffuse * ((1.0 - max_component(specular)) / pi) + specular * lobe) * n_dot_l;
}

#endif
