#ifndef KILN_HAIR_GLSL
#define KILN_HAIR_GLSL
// Scattering of a hair fibre after Chiang, Bitterli, Tappan and Burley, "A Practical and Controllable Hair and Fur Model
// for Production Path Tracing", EGSR 2016, itself after Marschner et al. 2003 and d'Eon et al. 2011:
//   S = sum over p of Mp(theta_i, theta_o) Ap(theta_o, h) Np(phi),   p = 0 (R), 1 (TT), 2 (TRT), 3 (all further ones)
// S is the scattering function times the cosine of the incident angle: radiance out = integral of S L dw.
//
// Directions stand in the fibre's frame: x along the fibre from root to tip, y and z across it. theta is the angle from
// the plane across the fibre (sin theta = w.x), phi = atan(z, y) the angle around it. h in [-1, 1] is where across the
// fibre's width the ray out of the eye meets it: h = sin gamma_o with the surface's normal there at phi_o - gamma_o.
#include "bessel.glsl"
#include "math.glsl"

// beta_m, beta_n: perceptual roughness along and around the fibre, [0.05, 1]; eta: index of refraction, [1.05, 2.5], 1.55
// for hair; absorption: per fibre radius, [0, inf); tilt: of the cuticle's scales, radians, [-0.2, 0.2], 0.035 for hair.
struct HairFibre {
    vec3 absorption;
    float eta;
    float beta_m;
    float beta_n;
    float tilt;
};

// Unpolarised dielectric reflectance seen from outside, g = sqrt(eta^2 - 1 + c^2) (Cook and Torrance 1982):
//   F = 1/2 ((g - c) / (g + c))^2 (1 + ((c (g + c) - 1) / (c (g - c) + 1))^2)
// cosine: [0, 1]; eta: (1, 2.5].
float hair_fresnel(float cosine, float eta) {
    const float g = sqrt(max(eta * eta - 1.0 + cosine * cosine, 0.0));
    const float a = (g - cosine) / (g + cosine);
    const float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

// Variance of the longitudinal lobe p (0 to 3) for beta_m (Chiang 2016, equation 7, and its table of lobes):
//   v0 = (0.726 b + 0.812 b^2 + 3.7 b^20)^2,   v1 = v0 / 4,   v2 = v3 = 4 v0
// At least 1e-5, which is the lobe of a fibre twice as smooth as the range of beta_m asks for.
float hair_variance(int p, float beta_m) {
    const float b2 = beta_m * beta_m;
    const float b4 = b2 * b2;
    const float b16 = b4 * b4 * b4 * b4;
    const float root = 0.726 * beta_m + 0.812 * b2 + 3.7 * b16 * b4;
    const float v = root * root;
    return max(p == 0 ? v : (p == 1 ? 0.25 * v : 4.0 * v), 1e-5);
}

// Scale of the azimuthal logistic for beta_n (Chiang 2016, equation 8): sqrt(pi/8) (0.265 b + 1.194 b^2 + 5.372 b^22).
float hair_logistic_scale(float beta_n) {
    const float b2 = beta_n * beta_n;
    const float b4 = b2 * b2;
    const float b16 = b4 * b4 * b4 * b4;
    return max(0.626657069 * (0.265 * beta_n + 1.194 * b2 + 5.372 * b16 * b4 * b2), 1e-3);
}

// The longitudinal lobe (d'Eon et al. 2011, equation 7), integral of Mp cos(theta_i) d theta_i = 1:
//   Mp = exp(-si so / v) I0(ci co / v) / (2 v sinh(1/v))
// sinh(1/v) overflows fp32 below v = 0.0112. The exponentials are gathered instead: ci co - si so - 1 is
// -((ci - co)^2 + (si + so)^2) / 2 for unit pairs, never above 0, and what remains of I0 and sinh is scaled:
//   Mp = exp(-((ci - co)^2 + (si + so)^2) / (2v)) (exp(-x) I0(x)) / (v (1 - exp(-2/v))),   x = ci co / v
// (si, ci), (so, co): sine and cosine of theta_i and theta_o, each a unit pair, cosines in [0, 1]; v: [1e-5, 10].
float hair_longitudinal(float si, float ci, float so, float co, float v) {
    const float dc = ci - co;
    const float ds = si + so;
    const float exponent = -0.5 * (dc * dc + ds * ds) / v;
    return exp(exponent) * bessel_i0_scaled(ci * co / v) / (v * (1.0 - exp(-2.0 / v)));
}

// The azimuthal lobe (Chiang 2016, equation 6): a logistic about the direction that a ray leaves a smooth fibre in,
// cut at +-pi and scaled to integrate to 1 there.
//   Phi = 2 p gamma_t - 2 gamma_o + p pi,   x = phi - Phi wrapped to [-pi, pi],   e = exp(-|x| / s)
//   Np = e / (s (1 + e)^2 tanh(pi / (2s)))
// phi: phi_i - phi_o, radians, any; p: 0 to 2; s: [1e-3, 10]; gammas: [-pi/2, pi/2].
float hair_azimuthal(float phi, int p, float s, float gamma_o, float gamma_t) {
    const float q = float(p);
    const float d = phi - (2.0 * q * gamma_t - 2.0 * gamma_o + q * pi);
    const float x = d - 2.0 * pi * floor(d / (2.0 * pi) + 0.5);
    const float e = exp(-abs(x) / s);
    const float cut = exp(-pi / s);
    return e * (1.0 + cut) / (s * (1.0 + e) * (1.0 + e) * (1.0 - cut));
}

// The share of light that leaves a fibre by lobe p: f is the reflectance at the surface, t what one crossing lets through.
//   A0 = f,   A1 = (1 - f)^2 t,   A2 = (1 - f)^2 t^2 f,   A3 = (1 - f)^2 t^3 f^2 / (1 - t f)  (the rest of the series)
// They sum to 1 where t = 1. The denominator is taken as (1 - f) + f (1 - t), of which no part cancels, and one 1 - f stands
// directly over it, which leaves a quotient of at most 1.
// p: 0 to 3; f, t: [0, 1].
vec3 hair_attenuation(int p, float f, vec3 t) {
    if (p == 0) return vec3(f);
    const float enters = 1.0 - f;
    if (p == 1) return enters * enters * t;
    if (p == 2) return enters * enters * f * t * t;
    const vec3 tf = t * f;
    return enters * t * tf * tf * (enters / max(vec3(enters) + f * (vec3(1.0) - t), vec3(1e-20)));
}

// What one crossing of the fibre lets through: exp(-absorption 2 cos(gamma_t) / cos(theta_t)).
// absorption: per radius, [0, inf); cos_gamma_t: [0, 1]; cos_theta_t: (0, 1].
vec3 hair_transmittance(vec3 absorption, float cos_gamma_t, float cos_theta_t) {
    return exp(-absorption * (2.0 * cos_gamma_t / cos_theta_t));
}

// Absorption that gives a head of hair the colour c after many scatterings (Chiang 2016, section 4.2):
//   (ln c / (5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5))^2,   b = beta_n
// colour: (0, 1]; below 1e-3 taken as 1e-3.
vec3 hair_absorption(vec3 colour, float beta_n) {
    const float b = beta_n;
    const float d = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
    const vec3 x = log(clamp(colour, vec3(1e-3), vec3(1.0))) / d;
    return x * x;
}

// S of the whole fibre for one h. to_light, to_eye: unit, in the fibre's frame, away from the fibre; h: [-1, 1].
// The scales' tilt turns theta_o by -2, 1 and 4 tilts in R, TT and TRT (Chiang 2016, section 3.3).
vec3 hair_chiang(HairFibre fibre, vec3 to_light, vec3 to_eye, float h) {
    const float si = clamp(to_light.x, -1.0, 1.0);
    const float ci = length(to_light.yz);
    const float so = clamp(to_eye.x, -1.0, 1.0);
    const float co = length(to_eye.yz);
    const float across = to_eye.y * to_light.z - to_eye.z * to_light.y;
    const float along = dot(to_eye.yz, to_light.yz);
    const float phi = across == 0.0 && along == 0.0 ? 0.0 : atan(across, along);

    const float sin_gamma_o = clamp(h, -1.0, 1.0);
    const float cos_gamma_o = sqrt((1.0 - sin_gamma_o) * (1.0 + sin_gamma_o));
    // Snell's law in the plane across the fibre, with Bravais' index sqrt(eta^2 - so^2) / co.
    const float sin_gamma_t = clamp(sin_gamma_o * co * inversesqrt(fibre.eta * fibre.eta - so * so), -1.0, 1.0);
    const float cos_gamma_t = sqrt((1.0 - sin_gamma_t) * (1.0 + sin_gamma_t));
    const float sin_theta_t = so / fibre.eta;
    const float cos_theta_t = sqrt((1.0 - sin_theta_t) * (1.0 + sin_theta_t));
    const float gamma_o = atan(sin_gamma_o, cos_gamma_o);
    const float gamma_t = atan(sin_gamma_t, cos_gamma_t);

    const float f = hair_fresnel(co * cos_gamma_o, fibre.eta);
    const vec3 t = hair_transmittance(fibre.absorption, cos_gamma_t, cos_theta_t);
    const float s = hair_logistic_scale(fibre.beta_n);
    vec3 sum = hair_attenuation(3, f, t) * (hair_longitudinal(si, ci, so, co, hair_variance(3, fibre.beta_m)) / (2.0 * pi));
    for (int p = 0; p < 3; ++p) {
        const float turn = fibre.tilt * (p == 0 ? -2.0 : (p == 1 ? 1.0 : 4.0));
        const float sine = sin(turn);
        const float cosine = cos(turn);
        const float tilted_so = so * cosine + co * sine;
        const float tilted_co = abs(co * cosine - so * sine);
        sum += hair_attenuation(p, f, t) *
               (hair_longitudinal(si, ci, tilted_so, tilted_co, hair_variance(p, fibre.beta_m)) *
                hair_azimuthal(phi, p, s, gamma_o, gamma_t));
    }
    return sum;
}

// S averaged over the fibre's width by the midpoint rule in HAIR_WIDTH_STEPS steps of h: a fibre thinner than a pixel.
#ifndef HAIR_WIDTH_STEPS
#define HAIR_WIDTH_STEPS 16
#endif
vec3 hair_chiang_width(HairFibre fibre, vec3 to_light, vec3 to_eye) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < HAIR_WIDTH_STEPS; ++i) {
        const float h = (2.0 * float(i) + 1.0) / float(HAIR_WIDTH_STEPS) - 1.0;
        sum += hair_chiang(fibre, to_light, to_eye, h);
    }
    return sum / float(HAIR_WIDTH_STEPS);
}

#endif
