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

#endif
