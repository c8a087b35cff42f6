#ifndef KILN_VECTORS_GLSL
#define KILN_VECTORS_GLSL
// Directions and normals.

// v scaled to unit length, or `fallback` when v is shorter than 1e-37. Dividing by the largest component first keeps
// dot(v, v) from overflowing or vanishing for any finite v; Vulkan bounds the division's error up to 2^126 (8.5e37).
// fallback: unit vector.
vec3 safe_normalize(vec3 v, vec3 fallback) {
    const float largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    const vec3 scaled = v / max(largest, 1e-37);
    return largest > 1e-37 ? scaled * inversesqrt(dot(scaled, scaled)) : fallback;
}

// A normal through an affine map, not normalised: the inverse transpose up to a positive factor. Made from the cofactors,
// so that a singular `m` (a scale of 0 along one axis) divides by nothing; times the determinant's sign, so that a
// mirrored object keeps its outside. m: the upper 3 x 3 of object to world; n: object space.
vec3 transform_normal(mat3 m, vec3 n) {
    const vec3 c0 = cross(m[1], m[2]);
    const vec3 transformed = mat3(c0, cross(m[2], m[0]), cross(m[0], m[1])) * n;
    return dot(m[0], c0) < 0.0 ? -transformed : transformed;
}

#endif
