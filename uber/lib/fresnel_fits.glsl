#ifndef KILN_FRESNEL_FITS_GLSL
#define KILN_FRESNEL_FITS_GLSL
// Fits of Fresnel's equations beside the fresnel_schlick of fresnel.glsl, cheaper ones and nearer ones.
#include "fresnel.glsl"

// Schlick with the reflectance at grazing incidence given: f0 + (f90 - f0) (1 - cos)^5.
// cosine: limited to [0, 1] here; f0, f90: [0, 1].
vec3 fresnel_schlick_f90(float cosine, vec3 f0, vec3 f90) {
    const float x = 1.0 - saturate(cosine);
    const float x2 = x * x;
    return f0 + (f90 - f0) * (x2 * x2 * x);
}

// fresnel_schlick with the power as pow(x, 5.0), which costs a log2 and an exp2 and gains nothing; kept to be measured.
// cosine: limited to [0, 1] here; f0: [0, 1].
vec3 fresnel_schlick_pow(float cosine, vec3 f0) {
    return f0 + (vec3(fresnel_f90(f0)) - f0) * pow(1.0 - saturate(cosine), 5.0);
}

// Schlick with (1 - c)^5 replaced by 2^((-5.55473 c - 6.98316) c), Karis, "Real Shading in Unreal Engine 4", 2013. The
// power differs by at most 3.8e-3 (at c = 0.055), and is 1.7e-4 in place of 0 at c = 1.
// cosine: limited to [0, 1] here; f0: [0, 1].
vec3 fresnel_spherical_gaussian(float cosine, vec3 f0) {
    const float c = saturate(cosine);
    return f0 + (vec3(fresnel_f90(f0)) - f0) * exp2((-5.55473 * c - 6.98316) * c);
}

// Schlick less a dip for metals: F = S(c) - a c (1 - c)^6 (Lazanyi and Szirmay-Kalos, "Fresnel Term Approximations for
// Metals", 2005). c (1 - c)^6 is largest at c = 1/7, 82 degrees, and a makes F be f82 there (Hoffman, "Fresnel Equations
// Considered Harmful", 2019):  a = (S(1/7) - f82) / (1/7 (6/7)^6).  Limited to [0, 1], which the fit may leave for an f82 far
// from S(1/7). cosine: limited to [0, 1] here; f0, f82: [0, 1].
vec3 fresnel_f82(float cosine, vec3 f0, vec3 f82) {
    const float c = saturate(cosine);
    const float x = 1.0 - c;
    const float x2 = x * x;
    const float x4 = x2 * x2;
    const vec3 at_82 = f0 + (vec3(1.0) - f0) * 0.462664366;                     // (6/7)^5
    const vec3 a = (at_82 - f82) * 17.6513846;                                   // 7 (7/6)^6
    return clamp(f0 + (vec3(1.0) - f0) * (x4 * x) - a * (c * x4 * x2), vec3(0.0), vec3(1.0));
}

// fresnel_schlick for a specular colour that may have been pushed out of [0, 1]: finite and never negative for a finite f0,
// and the plain one inside [0, 1]. Above 1 it makes energy, as was asked for. cosine: limited to [0, 1] here.
vec3 fresnel_schlick_pushed(float cosine, vec3 f0) {
    return max(fresnel_schlick(cosine, f0), vec3(0.0));
}

#endif
