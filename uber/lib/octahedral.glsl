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

#endif
