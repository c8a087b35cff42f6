#ifndef KILN_LIGHTS_GLSL
#define KILN_LIGHTS_GLSL
// Punctual lights: how much of an intensity arrives at a distance and in a direction.
// Lagarde and de Rousiers, "Moving Frostbite to Physically Based Rendering 3.0", SIGGRAPH 2014, section 4.
#include "math.glsl"

// The share of a point light's intensity that arrives at distance d, in 1/m^2: 1/d^2, flat within 1 cm, where the inverse
// square would grow without bound, times a window that takes it to exactly 0 at `range` with zero slope.
//   window = sat(1 - (d / range)^4)^2     (Karis, "Real Shading in Unreal Engine 4", 2013)
// distance_squared: m^2, >= 0; range: metres, > 0.
float distance_attenuation(float distance_squared, float range) {
    const float t = distance_squared / max(range * range, 1e-12);
    const float window = saturate(1.0 - t * t);
    return window * window / max(distance_squared, 1e-4);
}

// The share of a spot light's intensity that leaves at an angle from its axis: sat((c - outer) / (inner - outer))^2.
// cos_angle, cos_inner, cos_outer: cosines, in [-1, 1]; inner at or below outer gives a hard edge.
float cone_attenuation(float cos_angle, float cos_inner, float cos_outer) {
    const float t = saturate((cos_angle - cos_outer) / max(cos_inner - cos_outer, 1e-3));
    return t * t;
}

// A lamp's intensity in candela from its luminous flux in lumen (>= 0). A point light sends it all ways: flux / 4 pi. A spot light's is
// flux / pi whatever its angle, as if a reflector gathered it, so that narrowing a cone does not make it brighter.
float point_light_intensity(float lumen) {
    return lumen * (0.25 / pi);
}
float spot_light_intensity(float lumen) {
    return lumen * (1.0 / pi);
}

#endif
