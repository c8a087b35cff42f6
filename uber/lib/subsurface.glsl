#ifndef KILN_SUBSURFACE_GLSL
#define KILN_SUBSURFACE_GLSL
// Light that leaves a surface elsewhere than it entered: wrapped diffuse, the normalised diffusion profile and the classical
// dipole. A profile R(r) is radiant exitance at distance r per flux that enters at a point; integral of R 2 pi r dr is the
// albedo. Lengths are in the caller's unit, whichever.
#include "math.glsl"

// Wrapped diffuse, (n.l + w) / (1 + w) not below 0, over its integral across the sphere, pi (1 + w), so that no energy is
// made: max(0, n.l + w) / (1 + w)^2. Without the second 1 + w it reflects 1 + w times what arrives.
// n_dot_l: [-1, 1]; wrap: [0, 1]. w = 0 is Lambert's cosine.
float wrap_diffuse(float n_dot_l, float wrap) {
    const float scale = 1.0 + wrap;
    return max(n_dot_l + wrap, 0.0) / (scale * scale);
}

// The profile's shape s for an albedo: R's lengths shrink by it. Christensen and Burley, "Approximate Reflectance Profiles
// for Efficient Subsurface Scattering", SIGGRAPH 2015, equations 5, 6 and 8: light entering as a searchlight, at a diffuse
// boundary, and with the diffuse mean free path as the unit instead of the mean free path.
// albedo: [0, 1] of the whole surface, not of one scattering. Divide by the (diffuse) mean free path for s in 1/length.
vec3 burley_shape_searchlight(vec3 albedo) {
    const vec3 x = abs(albedo - 0.8);
    return 1.85 - albedo + 7.0 * x * x * x;
}
vec3 burley_shape_diffuse(vec3 albedo) {
    const vec3 x = albedo - 0.8;
    return 1.9 - albedo + 3.5 * x * x;
}
vec3 burley_shape_mean_free_path(vec3 albedo) {
    const vec3 x = albedo - 0.33;
    const vec3 x2 = x * x;
    return 3.5 + 100.0 * x2 * x2;
}

// Albedo of one scattering that gives a half space of isotropic scatterers the albedo A (Chiang, Kutz and Burley,
// "Practical and Controllable Subsurface Scattering for Production Path Tracing", SIGGRAPH 2016 talks):
//   1 - exp(-5.09406 A + 2.61188 A^2 - 4.31805 A^3). albedo: [0, 1].
vec3 single_scattering_albedo(vec3 albedo) {
    return 1.0 - exp(albedo * (-5.09406 + albedo * (2.61188 - albedo * 4.31805)));
}

// Burley's normalised diffusion, over the albedo and times r, which is bounded where R itself is not:
//   r R(r) / A = s (exp(-s r) + exp(-s r / 3)) / (8 pi)
// r: [0, inf); s: (0, inf), 1/length.
vec3 burley_profile_r(float r, vec3 s) {
    const vec3 e = exp(-s * (r / 3.0));
    return s * (e * e * e + e) / (8.0 * pi);
}

// R(r) / A itself, flat within r = 1e-4 / s: 2.5e-5 of the whole are lost there.
vec3 burley_profile(float r, vec3 s) {
    const vec3 e = exp(-s * (r / 3.0));
    return s * (e * e * e + e) / (8.0 * pi * max(vec3(r), 1e-4 / s));
}

// The share of R within r: 1 - exp(-s r) / 4 - 3 exp(-s r / 3) / 4. With g = exp(-s r / 3) that is
// (1 - g) (4 + g + g^2) / 4, in which only 1 - g cancels. r: [0, inf); s: (0, inf).
float burley_cumulative(float r, float s) {
    const float x = s * r / 3.0;
    const float g = exp(-x);
    const float one_minus_g = x < 0.01 ? x * (1.0 - x * (0.5 - x / 6.0)) : 1.0 - g;
    return one_minus_g * (4.0 + g + g * g) * 0.25;
}

// The inverse: r within which lies the share u. g^3 + 3 g = 4 (1 - u) = 4q is a cubic with one real root,
//   g = w - 1/w,   w^3 = 2q + sqrt(4 q^2 + 1)
// (Golubev, "Sampling Burley's Normalized Diffusion Profiles", 2019), here g = 4q / (w^2 + 1 + 1/w^2), which does not
// cancel for small q. For small u it is y = 1 - g that is needed: y (6 - 3y + y^2) = 4u by two steps of Newton's method
// from 2u/3, and -ln(1 - y) as a series, so that r keeps its relative precision down to 0.
// u: [0, 1], from 1 - 1e-7 on taken as that; s: (0, inf).
float burley_radius(float u, float s) {
    if (u < 0.1) {
        float y = 2.0 / 3.0 * u;
        y -= (y * (6.0 + y * (y - 3.0)) - 4.0 * u) / (6.0 + y * (3.0 * y - 6.0));
        y -= (y * (6.0 + y * (y - 3.0)) - 4.0 * u) / (6.0 + y * (3.0 * y - 6.0));
        return 3.0 * y * (1.0 + y * (1.0 / 2.0 + y * (1.0 / 3.0 + y * (1.0 / 4.0 + y * (1.0 / 5.0 + y / 6.0))))) / s;
    }
    const float q = max(1.0 - u, 1e-7);
    const float w = exp2(log2(2.0 * q + sqrt(4.0 * q * q + 1.0)) / 3.0);
    const float w2 = w * w;
    return -3.0 * log(4.0 * q / (w2 + 1.0 + 1.0 / w2)) / s;
}

// Tap i of n over a disc, at the middle of the i-th share and on golden angles: offset.xy and the radius. Taps stand with
// the density of R for s; each is worth 1/n, times burley_tap_weight for a channel with another s.
// i: [0, n); rotation: radians, any.
vec3 burley_tap(int i, int n, float s, float rotation) {
    const float r = burley_radius((float(i) + 0.5) / float(n), s);
    return vec3(-r * cos_sin_of_turn(fract(0.381966011 * float(i) + rotation / (2.0 * pi))), r);
}

// What a tap drawn with s_drawn counts in channels with s: R(r; s) / R(r; s_drawn). No 1/r is left in it. At most
// s / s_drawn where s >= s_drawn: draw with the smallest s. r: [0, 50 / s_drawn].
vec3 burley_tap_weight(float r, vec3 s, float s_drawn) {
    const vec3 e = exp(-s * (r / 3.0));
    const float d = exp(-s_drawn * (r / 3.0));
    return s * (e * e * e + e) / max(s_drawn * (d * d * d + d), 1e-30);
}

// Through a slab: diffuse light on its back over what leaves its front, divided by the albedo. The profile between two planes
// d apart, R(sqrt(x^2 + y^2 + d^2)), over the plane is the share of R beyond d:
//   (exp(-s d) + 3 exp(-s d / 3)) / 4
// Golubev, "Efficient Screen-Space Subsurface Scattering Using Burley's Normalized Diffusion in Real-Time", SIGGRAPH 2018.
// thickness: [0, inf), as long as 1/s is; s: (0, inf).
vec3 burley_transmittance(float thickness, vec3 s) {
    const vec3 e = exp(-s * (thickness / 3.0));
    return 0.25 * e * (e * e + 3.0);
}

// Tap i of n over the back of a slab, for what is seen on the other side: offset.xy and the distance through the slab. Taps
// stand with that profile's density; each is worth burley_transmittance / n.
// i: [0, n); s thickness: [0, 30]; rotation: radians, any.
vec3 burley_through_tap(int i, int n, float s, float thickness, float rotation) {
    const float beyond = burley_transmittance(thickness, vec3(s)).x;
    const float rest = 1.0 - (float(i) + 0.5) / float(n);
    const float rho = max(burley_radius(1.0 - beyond * rest, s), thickness);
    const float r = sqrt((rho - thickness) * (rho + thickness));
    return vec3(-r * cos_sin_of_turn(fract(0.381966011 * float(i) + rotation / (2.0 * pi))), rho);
}

// Irradiance around uv, spread by Burley's profile of a flat surface, BURLEY_TAPS taps, over the weights' sum.
// uv_per_length: how far one unit of length is in uv; s_drawn: the smallest component of s. Reads the only level.
#ifndef BURLEY_TAPS
#define BURLEY_TAPS 32
#endif
vec3 burley_gather(sampler2D irradiance, vec2 uv, vec2 uv_per_length, vec3 s, float s_drawn, float rotation) {
    vec3 sum = vec3(0.0);
    vec3 weights = vec3(0.0);
    for (int i = 0; i < BURLEY_TAPS; ++i) {
        const vec3 tap = burley_tap(i, BURLEY_TAPS, s_drawn, rotation);
        const vec3 weight = burley_tap_weight(tap.z, s, s_drawn);
        sum += weight * textureLod(irradiance, uv + tap.xy * uv_per_length, 0.0).rgb;
        weights += weight;
    }
    return sum / weights;
}

// The diffuse Fresnel reflectance within the medium, -1.440/eta^2 + 0.710/eta + 0.668 + 0.0636 eta, and with it the
// boundary's (1 + F) / (1 - F). Jensen, Marschner, Levoy and Hanrahan, "A Practical Model for Subsurface Light Transport",
// SIGGRAPH 2001, section 2.1. eta: [1, 2]; 1 gives 1.0032 from the fit, not 1.
float dipole_boundary(float eta) {
    const float f = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
    return (1.0 + f) / (1.0 - f);
}

// The dipole's albedo (the same, equation 15): a/2 (1 + exp(-4/3 A q)) exp(-q), q = sqrt(3 (1 - a)).
// albedo a: of one reduced scattering, [0, 1]; boundary: of dipole_boundary.
vec3 dipole_albedo(vec3 albedo, float boundary) {
    const vec3 q = sqrt(3.0 * max(1.0 - albedo, 0.0));
    return 0.5 * albedo * (1.0 + exp(-4.0 / 3.0 * boundary * q)) * exp(-q);
}

// The classical dipole (the same, equation 4): a source 1/sigma_t below the surface and its mirror image above,
//   R = a / (4 pi) (z_r (1 + tr d_r) exp(-tr d_r) / d_r^3 + z_v (1 + tr d_v) exp(-tr d_v) / d_v^3)
// with z_r = 1/sigma_t, z_v = z_r (1 + 4A/3), d^2 = r^2 + z^2, tr = sqrt(3 sigma_a sigma_t).
// r: [0, inf); sigma_s (reduced), sigma_a: 1/length, [0, inf), not both 0; boundary: of dipole_boundary.
vec3 dipole_profile(float r, vec3 sigma_s, vec3 sigma_a, float boundary) {
    const vec3 sigma_t = sigma_s + sigma_a;
    const vec3 tr = sqrt(3.0 * sigma_a * sigma_t);
    const vec3 zr = 1.0 / sigma_t;
    const vec3 zv = zr * (1.0 + 4.0 / 3.0 * boundary);
    const vec3 dr = sqrt(r * r + zr * zr);
    const vec3 dv = sqrt(r * r + zv * zv);
    const vec3 real = zr * (1.0 + tr * dr) * exp(-tr * dr) / (dr * dr * dr);
    const vec3 image = zv * (1.0 + tr * dv) * exp(-tr * dv) / (dv * dv * dv);
    return sigma_s / sigma_t * (real + image) / (4.0 * pi);
}

// The dipole's answer for a slab under diffuse light, all mirror images summed (Donner and Jensen, "Light Diffusion in
// Multi-Layered Translucent Materials", SIGGRAPH 2005, over the plane). With the source at z_r = 2/(3 sigma_t) below the lit
// face, where diffuse light first scatters on average (a beam along the normal, as in the paper: 1/sigma_t), z_b = 2A/(3 sigma_t)
// and tr = sqrt(3 sigma_a sigma_t) what comes out of the other is
//   a sinh(tr (z_r + z_b)) cosh(tr z_b) / sinh(tr (d + 2 z_b))
// here in exponentials that do not overflow. In a slab thinner than z_r the source is on the far face; light that
// crosses unscattered is left out.
// thickness: [0, inf); sigma_s (reduced), sigma_a: 1/length, [0, inf), not both 0, tr below 1e-3 sigma_t counts as that;
// boundary: of dipole_boundary.
vec3 multipole_transmittance(float thickness, vec3 sigma_s, vec3 sigma_a, float boundary) {
    const vec3 sigma_t = sigma_s + sigma_a;
    const vec3 tr = max(sqrt(3.0 * sigma_a * sigma_t), 1e-3 * sigma_t);
    const vec3 beyond = 2.0 / 3.0 * boundary / sigma_t;
    const vec3 depth = min(2.0 / 3.0 / sigma_t, vec3(thickness));
    const vec3 into = 1.0 - exp(-2.0 * tr * (depth + beyond));
    const vec3 out_of = 1.0 + exp(-2.0 * tr * beyond);
    const vec3 across = 1.0 - exp(-2.0 * tr * (thickness + 2.0 * beyond));
    return 0.5 * sigma_s / sigma_t * exp(-tr * (thickness - depth)) * into * out_of / across;
}

#endif
