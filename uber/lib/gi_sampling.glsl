#ifndef KILN_GI_SAMPLING_GLSL
#define KILN_GI_SAMPLING_GLSL
// Random numbers and directions for indirect light.
#include "math.glsl"

// The next state of a permuted congruential generator and its output (Jarzynski and Olano, "Hash Functions for GPU
// Rendering", JCGT 9(3), 2020: pcg). Seed with something different for every pixel.
uint gi_random_bits(inout uint state) {
    state = state * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In [0, 1), 24 bits.
float gi_random(inout uint state) {
    return float(gi_random_bits(state) >> 8u) * (1.0 / 16777216.0);
}

// Two unit vectors across n and each other (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
// n: unit.
void gi_basis(vec3 n, out vec3 t, out vec3 b) {
    const float s = n.z >= 0.0 ? 1.0 : -1.0;
    const float a = -1.0 / (s + n.z);
    const float c = n.x * n.y * a;
    t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
    b = vec3(c, s + n.y * n.y * a, -n.y);
}

// A direction about n with density cos / pi: on a disc of radius sqrt(u.x), lifted (Malley). u: [0, 1)^2; n: unit.
vec3 gi_cosine_direction(vec2 u, vec3 n) {
    vec3 t, b;
    gi_basis(n, t, b);
    const vec2 p = -sqrt(u.x) * cos_sin_of_turn(u.y);
    return t * p.x + b * p.y + n * sqrt(max(1.0 - u.x, 0.0));
}

// Point i of n of Hammersley's set, turned by shift (Cranley and Patterson). i: [0, n); shift: [0, 1)^2.
vec2 gi_hammersley(int i, int n, vec2 shift) {
    const float y = float(bitfieldReverse(uint(i)) >> 8u) * (1.0 / 16777216.0);
    return fract(vec2((float(i) + 0.5) / float(n), y) + shift);
}

#endif
