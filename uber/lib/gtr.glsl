#ifndef KILN_GTR_GLSL
#define KILN_GTR_GLSL
// Generalized Trowbridge-Reitz with exponent 1 (Burley, "Physically-Based Shading at Disney", 2012), whose tail is longer
// than that of GGX, which is exponent 2: see ggx.glsl.
#include "math.glsl"

// -ln(1 - u) / u, which is 1 at u = 0. log2 knows its result near argument 1 only to an absolute error, so small u take
// 2 atanh(z), z = u / (2 - u), by its series; what the series leaves out is below 2e-8. u: [0, 1).
float log_ratio(float u) {
    const float z = u / (2.0 - u);
    const float z2 = z * z;
    const float near = 2.0 / (2.0 - u) * (1.0 + z2 * (1.0 / 3.0 + z2 * (1.0 / 5.0 + z2 / 7.0)));
    return u < 0.25 ? near : -log(1.0 - u) / u;
}

// The GTR1 distribution, normalised so that its integral with n.h is 1, per steradian:
//   D = (a^2 - 1) / (pi ln(a^2) (1 + (a^2 - 1) (n.h)^2))
//     = 1 / (pi (-ln(a^2) / (1 - a^2)) (a^2 + (1 - a^2) sin^2)),   sin^2 = c (1 - c/4),  c = |h - n|^2 as in ggx.glsl
// Finite at alpha = 1, where it is 1 / pi. n, h: unit vectors; alpha: [1e-3, 1].
float gtr1_distribution(vec3 n, vec3 h, float alpha) {
    const vec3 d = h - n;
    const float c = dot(d, d);
    const float a2 = alpha * alpha;
    const float u = (1.0 - alpha) * (1.0 + alpha);
    const float ratio = u < 0.25 ? log_ratio(u) : -2.0 * log(alpha) / u;
    return 1.0 / (pi * ratio * (a2 + u * (c * (1.0 - 0.25 * c))));
}

#endif
