#ifndef KILN_OCTAHEDRAL_GLSL
#define KILN_OCTAHEDRAL_GLSL
// Unit vectors in two numbers.
// Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.

// A unit vector folded onto the octahedron |x| + |y| + |z| = 1 and unfolded into the square [-1, 1]^2.
vec2 encode_octahedral(vec3 n) {
    const vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    const vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return n.z >= 0.0 ? p : folded;
}

// The way back: folded up again where the octahedron's lower half lies, and made of unit length, which is never below
// 1 / sqrt(3) before. p: [-1, 1]^2.
vec3 decode_octahedral(vec2 p) {
    const float z = 1.0 - abs(p.x) - abs(p.y);
    const float fold = max(-z, 0.0);
    return normalize(vec3(p.x + (p.x >= 0.0 ? -fold : fold), p.y + (p.y >= 0.0 ? -fold : fold), z));
}

#endif
