#ifndef KILN_PCF_GLSL
#define KILN_PCF_GLSL
// Percentage-closer filtering: the mean of comparisons, never the comparison of a mean. Reeves, Salesin and Cook,
// "Rendering Antialiased Shadows with Depth Maps", 1987. Each tap compares against the receiver's plane at the tap
// (shadow_receiver.glsl), so that a wide filter needs no wide bias; slope 0 is a receiver that faces the light.
//
// place: uv and depth in [0, 1], from shadow_coordinates. slope: depth a uv. bias: depth, from receiver_depth_bias.
// Samplers compare with LESS_OR_EQUAL; every read names its level, so that all may stand in divergent code.
#include "math.glsl"

// One comparison at an offset in uv: 1 lit, 0 in shadow. Outside the map, and where the plane leaves its depth, lit.
float shadow_tap(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 offset) {
    const vec3 at = vec3(place.xy + offset, place.z + dot(slope, offset) - bias);
    const float lit = textureLod(map, at, 0.0);
    return all(greaterThanEqual(at.xy, vec2(0.0))) && all(lessThanEqual(at, vec3(1.0))) ? lit : 1.0;
}

// n x n taps at the centres of n x n equal parts of a box. Along an axis-aligned edge the sum has n + 1 levels, so that it is
// within 1 / (2 n) of the linear ramp that a box filter makes (1/6, 1/10, 1/14 for 3, 5, 7).
// width: of the box, uv, >= 0; n: 1 to 16.
float pcf_box(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 width, int n) {
    float lit = 0.0;
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const vec2 offset = ((vec2(x, y) + 0.5) / float(n) - 0.5) * width;
            lit += shadow_tap(map, place, slope, bias, offset);
        }
    }
    return lit / float(n * n);
}

float pcf_3(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 width) {
    return pcf_box(map, place, slope, bias, width, 3);
}
float pcf_5(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 width) {
    return pcf_box(map, place, slope, bias, width, 5);
}
float pcf_7(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 width) {
    return pcf_box(map, place, slope, bias, width, 7);
}

// Points of the unit disk as far from each other as 16 and 32 can be (repelling charges, then scaled): mean 0 and mean
// squared radius 1/2 to 1e-4, as a full disk has them; no two nearer than 0.440 and 0.298. From the centre outwards.
const vec2 poisson_disk_16[16] = vec2[16](
    vec2(-0.0708, 0.3642), vec2(-0.3696, 0.0376), vec2(0.3309, 0.1804), vec2(-0.1510, -0.3460),
    vec2(0.2802, -0.2571), vec2(-0.5965, 0.5539), vec2(-0.8005, 0.1478), vec2(-0.2063, 0.7875),
    vec2(0.2532, 0.7738), vec2(-0.7529, -0.3102), vec2(-0.4706, -0.6647), vec2(0.6278, 0.5189),
    vec2(0.8097, 0.0891), vec2(-0.0276, -0.8142), vec2(0.4123, -0.7027), vec2(0.7319, -0.3580)
);
const vec2 poisson_disk_32[32] = vec2[32](
    vec2(0.1697, -0.1863), vec2(-0.0263, 0.2511), vec2(-0.2564, 0.0528), vec2(-0.1313, -0.2274),
    vec2(0.2446, 0.1098), vec2(-0.4937, -0.2216), vec2(0.2693, 0.4696), vec2(0.5299, -0.1109),
    vec2(0.0581, -0.5384), vec2(-0.3637, 0.4013), vec2(0.3802, -0.4153), vec2(-0.0573, 0.5606),
    vec2(-0.5603, 0.1112), vec2(-0.2895, -0.4931), vec2(0.5256, 0.2363), vec2(-0.8587, -0.0489),
    vec2(0.8526, -0.1135), vec2(-0.0303, -0.8596), vec2(-0.8154, 0.2738), vec2(-0.6042, -0.6122),
    vec2(0.4780, 0.7151), vec2(0.7014, 0.4979), vec2(-0.7838, -0.3543), vec2(-0.1299, 0.8503),
    vec2(0.8372, 0.1975), vec2(-0.4244, 0.7482), vec2(-0.3328, -0.7932), vec2(0.7544, -0.4133),
    vec2(0.1880, 0.8394), vec2(-0.6656, 0.5449), vec2(0.2816, -0.8128), vec2(0.5530, -0.6589)
);

// A point turned by an angle. Turning the disk differently from pixel to pixel, the few levels of a small disk become noise,
// which the eye and a temporal filter forgive.
vec2 turned(vec2 point, vec2 cos_sin) {
    return vec2(point.x * cos_sin.x - point.y * cos_sin.y, point.x * cos_sin.y + point.y * cos_sin.x);
}

// radius: uv, >= 0. turn: [0, 1), any hash of the pixel, such as pixel_hash below.
float pcf_poisson_16(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 radius, float turn) {
    const vec2 cos_sin = cos_sin_of_turn(turn);
    float lit = 0.0;
    for (int i = 0; i < 16; ++i) {
        lit += shadow_tap(map, place, slope, bias, turned(poisson_disk_16[i], cos_sin) * radius);
    }
    return lit / 16.0;
}
float pcf_poisson_32(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 radius, float turn) {
    const vec2 cos_sin = cos_sin_of_turn(turn);
    float lit = 0.0;
    for (int i = 0; i < 32; ++i) {
        lit += shadow_tap(map, place, slope, bias, turned(poisson_disk_32[i], cos_sin) * radius);
    }
    return lit / 32.0;
}

// [0, 1) from a pixel's integer coordinates (gl_FragCoord.xy floored), exact in every target: 24 bits of the PCG hash of
// Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020.
float pixel_hash(uvec2 pixel) {
    const uint state = (pixel.x + pixel.y * 65536u) * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return float(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

#endif
