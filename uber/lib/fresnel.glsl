#ifndef KILN_FRESNEL_GLSL
#define KILN_FRESNEL_GLSL
// Fresnel reflectance.
#include "math.glsl"

// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994: f0 + (f90 - f0) (1 - cos)^5, the power by
// multiplication. A specular colour below 2 % is no real dielectric and means "no highlight": f90 falls with it there
// (Lagarde and de Rousiers 2014, f90 = sat(50 dot(f0, 0.33))).
// v_dot_h: cosine between view and half vector, limited to [0, 1] here; f0: reflectance at normal incidence, [0, 1].
// Returns values in [min(f0, f90), max(f0, f90)].
vec3 fresnel_schlick(float v_dot_h, vec3 f0) {
    const float f90 = saturate(50.0 * dot(f0, vec3(0.33)));
    const float x = 1.0 - saturate(v_dot_h);
    const float x2 = x * x;
    return f0 + (vec3(f90) - f0) * (x2 * x2 * x);
}

#endif
