#ifndef KILN_SUBSURFACE_SEPARABLE_GLSL
#define KILN_SUBSURFACE_SEPARABLE_GLSL
// Subsurface scattering as two blurs of irradiance, along x and along y: Jimenez et al., "Separable Subsurface Scattering",
// Computer Graphics Forum 34(6), 2015. Exact for an edge along an axis if the kernel is the profile's line spread.
#include "bessel.glsl"
#include "math.glsl"

#ifndef SEPARABLE_TAPS
#define SEPARABLE_TAPS 17
#endif

// Offset of tap i of n, odd: from -range to range, closer together near 0 by a square. i: [0, n); n: [3, 51].
float separable_offset(int i, int n, float range) {
    const float t = (2.0 * float(i)) / float(n - 1) - 1.0;
    return range * t * abs(t);
}

// The skin profile of d'Eon and Luebke 2007 in the red channel, without the narrowest Gaussian, which stands for light
// that is reflected where it enters; r in mm over falloff, which scales a channel. falloff: (0, 1].
vec3 separable_skin_profile(float r, vec3 falloff) {
    const vec3 q = r / max(falloff, vec3(1e-3));
    const vec3 x = -0.5 * q * q;
    return (0.100 / 0.0484 * exp(x / 0.0484) + 0.118 / 0.187 * exp(x / 0.187) + 0.113 / 0.567 * exp(x / 0.567) +
            0.358 / 1.99 * exp(x / 1.99) + 0.078 / 7.41 * exp(x / 7.41)) /
           (2.0 * pi);
}

// Jimenez' kernel: the profile itself at the taps times half the distance between a tap's neighbours, to sum 1, then mixed
// with no blur by strength. kernel[i]: weights in rgb, offset in a, in units of the blur's width, to +-3 for more than 20
// taps and +-2 for fewer. falloff: (0, 1]; strength: [0, 1].
void separable_kernel_skin(vec3 falloff, vec3 strength, out vec4 kernel[SEPARABLE_TAPS]) {
    const float range = SEPARABLE_TAPS > 20 ? 3.0 : 2.0;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < SEPARABLE_TAPS; ++i) {
        const float at = separable_offset(i, SEPARABLE_TAPS, range);
        const float left = separable_offset(max(i - 1, 0), SEPARABLE_TAPS, range);
        const float right = separable_offset(min(i + 1, SEPARABLE_TAPS - 1), SEPARABLE_TAPS, range);
        const vec3 weight = 0.5 * (right - left) * separable_skin_profile(at, falloff);
        kernel[i] = vec4(weight, at);
        sum += weight;
    }
    for (int i = 0; i < SEPARABLE_TAPS; ++i) {
        const vec3 centre = 2 * i == SEPARABLE_TAPS - 1 ? vec3(1.0) - strength : vec3(0.0);
        kernel[i].rgb = kernel[i].rgb / sum * strength + centre;
    }
}

// The line spread of Burley's profile over the albedo, R integrated along a line at the distance x:
//   L(x) = s (K0(s x) + K0(s x / 3)) / (4 pi)
// Its integral over x is 1; at 0 it has a logarithm's pole. x: (0, inf); s: 1/length, (0, inf).
float burley_line_spread(float x, float s) {
    const float y = s * x;
    return s * (bessel_k0_scaled(y) * exp(-y) + bessel_k0_scaled(y / 3.0) * exp(-y / 3.0)) / (4.0 * pi);
}

// A kernel of line spreads: tap i weighs the integral of L over its cell, in t with x = range t^2, where the pole is gone
// and cells are equal, by 4 midpoints. Sums to 1. kernel[i] as above with offsets in length.
// s: 1/length, (0, inf); range: length, of the order of 9 / (smallest s), beyond which lies 1.5 % of the light.
void separable_kernel_burley(vec3 s, float range, out vec4 kernel[SEPARABLE_TAPS]) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < SEPARABLE_TAPS; ++i) {
        vec3 weight = vec3(0.0);
        for (int j = 0; j < 4; ++j) {
            const float cell = float(i) + (float(j) + 0.5) / 4.0 - 0.5;
            const float t = abs(2.0 * cell / float(SEPARABLE_TAPS - 1) - 1.0);
            const float x = range * t * t;
            weight += t * vec3(burley_line_spread(x, s.x), burley_line_spread(x, s.y), burley_line_spread(x, s.z));
        }
        kernel[i] = vec4(weight, separable_offset(i, SEPARABLE_TAPS, range));
        sum += weight;
    }
    for (int i = 0; i < SEPARABLE_TAPS; ++i) kernel[i].rgb /= sum;
}

// One of the two blurs. axis: one unit of the kernel's offsets in uv, along x or along y. Reads the only level.
vec3 separable_gather(sampler2D irradiance, vec2 uv, vec2 axis, vec4 kernel[SEPARABLE_TAPS]) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < SEPARABLE_TAPS; ++i)
        sum += kernel[i].rgb * textureLod(irradiance, uv + axis * kernel[i].a, 0.0).rgb;
    return sum;
}

#endif
