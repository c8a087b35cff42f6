#ifndef KILN_TONEMAP_GLSL
#define KILN_TONEMAP_GLSL
// From scene radiance to a display's range: exposure, then a curve. Encoding (color.glsl) comes last. Curves take and give
// linear values, channel by channel or through luminance; none gives anything outside [0, 1] or falls as its argument rises.
#include "math.glsl"

// Rec. 709 luminance. c: linear.
float luminance(vec3 c) {
    return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

// The factor on radiance that maps the luminance which saturates a sensor of ISO 100 to 1:  1 / (1.2 2^ev).
// Lagarde and de Rousiers 2014, section 5.1. ev: exposure value, [-20, 30]; 15 in sunlight, 7 indoors.
float exposure_from_ev100(float ev) {
    return exp2(-ev) / 1.2;
}

// The same for a metered picture: a mean luminance L means 2^ev = 8 L, so that it comes out at 1 / 9.6.
// mean: cd/m2, held at or above 1e-6 here.
float exposure_from_mean(float mean) {
    return 1.0 / (9.6 * max(mean, 1e-6));
}

// What is stored in half floats: not below 0, not above the largest one. Anything from 65520 on would be stored as infinite.
vec3 limit_half(vec3 c) {
    return clamp(c, vec3(0.0), vec3(65504.0));
}

// Reinhard's x / (1 + x) as 1 - 1 / (1 + x), which is 1 and not inf / inf for what has overflowed. Reinhard et al.,
// "Photographic Tone Reproduction for Digital Images", 2002, equation 3. x: any; below 0 counts as 0.
float tone_reinhard(float x) {
    return 1.0 - 1.0 / (1.0 + max(x, 0.0));
}
vec3 tone_reinhard(vec3 c) { return vec3(tone_reinhard(c.x), tone_reinhard(c.y), tone_reinhard(c.z)); }

// Equation 4 of the same, on luminance, which keeps hues: what is as bright as `white` becomes 1, what is brighter stays there.
//   L (1 + L / white^2) / (1 + L),   the colour times that over L, at most 1 a channel
// c: any; below 0 counts as 0; above 65504 is cut. white: held at or above 1 here.
vec3 tone_reinhard_white(vec3 c, float white) {
    const vec3 x = limit_half(c);
    const float l = luminance(x);
    const float w = max(white, 1.0);
    return min(x * ((1.0 + l / (w * w)) / (1.0 + l)), vec3(1.0));
}

// A fit of the ACES reference transform for SDR screens, x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14). Narkowicz, "ACES
// Filmic Tone Mapping Curve", 2016. Reaches 1 at 7.24; x is cut at 8, or its square would overflow. x: any; below 0 counts as 0.
float tone_aces(float x) {
    const float y = clamp(x, 0.0, 8.0);
    return saturate(y * (2.51 * y + 0.03) / (y * (2.43 * y + 0.59) + 0.14));
}
vec3 tone_aces(vec3 c) { return vec3(tone_aces(c.x), tone_aces(c.y), tone_aces(c.z)); }

#endif
