#pragma once
// Directions and normals, as uber/lib/vectors.glsl names them.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// v / |v|, or `fallback` when no component of v is above 1e-37. Scaled by the largest component first, so that Bounded
// finds neither overflow nor underflow; in real numbers the scale cancels.
template <class T>
Vec3<T> safe_normalize(const Vec3<T>& v, const Vec3<T>& fallback) {
    const T largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if (!(largest > T(1e-37))) return fallback;
    const Vec3<T> scaled = v / max(largest, T(1e-37));
    return scaled * inversesqrt(dot(scaled, scaled));
}

// The cofactors of m times n, times the sign of m's determinant: |det m| times the inverse transpose.
template <class T>
Vec3<T> transform_normal(const Mat3<T>& m, const Vec3<T>& n) {
    const Vec3<T> c0 = cross(m.columns[1], m.columns[2]);
    const Mat3<T> cofactors{{c0, cross(m.columns[2], m.columns[0]), cross(m.columns[0], m.columns[1])}};
    const Vec3<T> transformed = cofactors * n;
    return dot(m.columns[0], c0) < T(0) ? -transformed : transformed;
}

}  // namespace kiln::reference
