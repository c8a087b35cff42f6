#ifndef KILN_GGX_FORMS_GLSL
#define KILN_GGX_FORMS_GLSL
// Other ways to write the ggx_distribution of ggx.glsl, the same function in exact arithmetic. They differ in how exactly
// they find sin^2 of the angle between n and h, which decides D near its peak.
#include "math.glsl"

// D from the square of the sine, k = a / (sin^2 + (a cos)^2), D = k^2 / pi.
// cosine, sine2: of the angle between n and h, [0, 1]; alpha: (0, 16].
float ggx_from_sine(float cosine, float sine2, float alpha) {
    const float a_cosine = alpha * cosine;
    const float k = alpha / (sine2 + a_cosine * a_cosine);
    return k * k / pi;
}

// sin^2 = |n x h|^2 (Lagrange's identity), as Filament has it. Each product of the cross product rounds before the two
// nearly equal ones are subtracted: relative error up to 1.2e-7 / alpha + 1e-6.
// n, h: unit vectors; alpha: [2e-3, 1].
float ggx_distribution_cross(vec3 n, vec3 h, float alpha) {
    const vec3 across = cross(n, h);
    return ggx_from_sine(dot(n, h), dot(across, across), alpha);
}

// sin^2 = (1 - c) (1 + c) from the cosine alone, where no vectors are left. c has forgotten angles below 0.02 degrees
// before this is called: relative error up to 5e-7 / alpha^2. n_dot_h: limited to [0, 1] here; alpha: [2e-3, 1].
float ggx_distribution_cosine(float n_dot_h, float alpha) {
    const float c = saturate(n_dot_h);
    return ggx_from_sine(c, (1.0 - c) * (1.0 + c), alpha);
}

#endif
