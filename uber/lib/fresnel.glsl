#ifndef KILN_FRESNEL_GLSL
#define KILN_FRESNEL_GLSL
// Fresnel reflectance.
#include "math.glsl"

// Reflectance at grazing incidence: 1, but for a specular colour below 2 %, which is no real dielectric and means "no
// highlight": it fades to 0 with f0. Lagarde and de Rousiers 2014. f0: [0, 1].
float fresnel_f90(vec3 f0) {
    return saturate(50.0 * dot(f0, vec3(0.33)));
}

// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994: f0 + (f90 - f0) (1 - cos)^5, the power by
// multiplication. cosine: between direction and (half) normal, limited to [0, 1] here; f0: reflectance at normal
// incidence, [0, 1]. Returns values in [min(f0, f90), max(f0, f90)].
vec3 fresnel_schlick(float cosine, vec3 f0) {
    const float x = 1.0 - saturate(cosine);
    const float x2 = x * x;
    return f0 + (vec3(fresnel_f90(f0)) - f0) * (x2 * x2 * x);
}

// The cosine-weighted mean of fresnel_schlick over the hemisphere: 2 integral of (1 - m)^5 m dm = 1/21. f0: [0, 1].
vec3 fresnel_average(vec3 f0) {
    return f0 + (vec3(fresnel_f90(f0)) - f0) / 21.0;
}

#endif
