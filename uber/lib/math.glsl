#ifndef KILN_MATH_GLSL
#define KILN_MATH_GLSL
// Small functions that GLSL lacks.

const float pi = 3.14159265358979;

// x limited to [0, 1].
float saturate(float x) {
    return clamp(x, 0.0, 1.0);
}

// The largest component of c.
float max_component(vec3 c) {
    return max(max(c.x, c.y), c.z);
}

// Cosine and sine of turn whole turns less a half: Vulkan bounds their errors on [-pi, pi] only. turn: [0, 1]. The negative is
// that of the whole turns.
vec2 cos_sin_of_turn(float turn) {
    const float angle = 2.0 * pi * (turn - 0.5);
    return vec2(cos(angle), sin(angle));
}

#endif
