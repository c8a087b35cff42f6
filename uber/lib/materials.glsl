#ifndef KILN_MATERIALS_GLSL
#define KILN_MATERIALS_GLSL
// From what artists paint to what the BRDFs take.
#include "math.glsl"

// Diffuse reflectance of a metallic-roughness material: base where it is no metal.
// base: linear, [0, 1]; metallic: limited to [0, 1] here.
vec3 metallic_diffuse(vec3 base, float metallic) {
    return base * (1.0 - saturate(metallic));
}

// Reflectance at normal incidence of a metallic-roughness material: 0.08 x dielectric_specular for a dielectric (0.5 gives
// the common 0.04), base for a metal. Burley 2012; Karis 2013. Exact conversion to specular-glossiness, whose glossiness
// is 1 - roughness; the way back needs a solve.
// base: linear, [0, 1]; metallic, dielectric_specular: limited to [0, 1] here.
vec3 metallic_f0(vec3 base, float metallic, float dielectric_specular) {
    return mix(vec3(0.08 * saturate(dielectric_specular)), base, saturate(metallic));
}

// A painted colour times its factor as a reflectance.
// texel, factor: linear; the product is limited to [0, 1].
vec3 reflectance(vec3 texel, vec3 factor) {
    return clamp(texel * factor, vec3(0.0), vec3(1.0));
}

#endif
