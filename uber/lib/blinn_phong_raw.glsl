#ifndef KILN_BLINN_PHONG_RAW_GLSL
#define KILN_BLINN_PHONG_RAW_GLSL
// Blinn-Phong without normalisation (Blinn 1977), as fixed-function hardware had it.
#include "math.glsl"
#include "vectors.glsl"

// max(x, 0)^p with 0^0 = 1, which GLSL's pow leaves open. x: any; p: limited to [0, 2048] here.
float phong_power(float x, float p) {
    return p > 0.0 ? pow(max(x, 0.0), min(p, 2048.0)) : 1.0;
}

// The BRDF times n.l, per steradian:  (kd / pi + ks (n.h)^p) n.l.  Reflects more than arrives as soon as ks exceeds
// blinn_phong_normalization(p): at p = 1 above 0.35, at p = 1000 above 40; and gets darker as p rises.
// n, v, l: unit vectors from the surface; diffuse (kd), specular (ks): [0, 1]; shininess: limited to [0, 2048] here.
vec3 blinn_phong_raw(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 specular, float shininess) {
    const vec3 h = safe_normalize(v + l, n);
    return (diffuse / pi + specular * phong_power(dot(n, h), shininess)) * saturate(dot(n, l));
}

#endif
