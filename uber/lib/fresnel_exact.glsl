#ifndef KILN_FRESNEL_EXACT_GLSL
#define KILN_FRESNEL_EXACT_GLSL
// Fresnel's equations for unpolarised light, without a fit. Born and Wolf, "Principles of Optics", sections 1.5 and 14.2.
#include "math.glsl"

// Reflectance at normal incidence of a dielectric: ((n - 1) / (n + 1))^2. ior: n outside over inside, (0, 1e6].
float dielectric_f0(float ior) {
    const float r = (ior - 1.0) / (ior + 1.0);
    return r * r;
}

// The index of refraction of a dielectric with this reflectance at normal incidence. f0: limited to [0, 0.999] here.
float dielectric_ior(float f0) {
    const float r = sqrt(clamp(f0, 0.0, 0.999));
    return (1.0 + r) / (1.0 - r);
}

// Dielectric. With c the cosine and g^2 = n^2 - 1 + c^2, the two polarisations reflect
//   rs = (c - g) / (c + g),   rp = (n^2 c - g) / (n^2 c + g),   F = (rs^2 + rp^2) / 2
// Both numerators cancel for n near 1 and are multiplied out over their conjugates:
//   |rs| = (n^2 - 1) / (c + g)^2,   rp = (n^2 - 1) (c^2 (n^2 + 1) - 1) / (n^2 c + g)^2
// 1 where g^2 < 0 (total reflection, ior below 1). At ior = 1 the result is 0.
// cosine: of incidence, limited to [0, 1] here; ior: of the side that the light would enter over that it comes from, [0.1, 1e3].
float fresnel_dielectric(float cosine, float ior) {
    const float c = saturate(cosine);
    const float contrast = (ior - 1.0) * (ior + 1.0);
    const float g2 = contrast + c * c;
    const float g = sqrt(max(g2, 0.0));
    const float s = c + g;
    const float p = ior * ior * c + g;
    const float rs = contrast / max(s * s, 1e-30);
    const float rp = contrast * (c * c * (ior * ior + 1.0) - 1.0) / max(p * p, 1e-30);
    return g2 < 0.0 ? 1.0 : 0.5 * (rs * rs + rp * rp);
}

// Conductor of complex index eta + i k against air. With t = eta^2 - k^2 - sin^2 and s = sqrt(t^2 + 4 eta^2 k^2) = a^2 + b^2:
//   a^2 = (s + t) / 2,   Rs = (s + c^2 - 2 a c) / (s + c^2 + 2 a c),
//   Rp = Rs (c^2 s + sin^4 - 2 a c sin^2) / (c^2 s + sin^4 + 2 a c sin^2),   F = (Rs + Rp) / 2
// (Lagarde, "Memo on Fresnel equations", 2013.) For a metal t < 0 and s + t cancels, so a^2 is 2 eta^2 k^2 / (s - t) there.
// cosine: limited to [0, 1] here; eta, k: [0, 1e3], not both 0.
float fresnel_conductor(float cosine, float eta, float k) {
    const float c = saturate(cosine);
    const float c2 = c * c;
    const float sin2 = (1.0 - c) * (1.0 + c);
    const float t = (eta - k) * (eta + k) - sin2;
    const float product = 2.0 * eta * k;
    const float s = sqrt(t * t + product * product);
    const float a2 = t < 0.0 ? 0.5 * product * product / max(s - t, 1e-30) : 0.5 * (s + t);
    const float cross_term = 2.0 * sqrt(a2) * c;
    const float rs = (s + c2 - cross_term) / max(s + c2 + cross_term, 1e-30);
    const float p = c2 * s + sin2 * sin2;
    return 0.5 * rs * (1.0 + (p - cross_term * sin2) / max(p + cross_term * sin2, 1e-30));
}

// The same for three wavelengths.
vec3 fresnel_conductor(float cosine, vec3 eta, vec3 k) {
    return vec3(fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
                fresnel_conductor(cosine, eta.z, k.z));
}

#endif
