#pragma once
// Unit vectors in two numbers, as uber/lib/octahedral.glsl names them. Cigolle et al., JCGT 3(2), 2014.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// A unit vector on the octahedron |x| + |y| + |z| = 1, its lower half folded outwards into the square [-1, 1]^2.
template <class T>
Vec2<T> encode_octahedral(const Vec3<T>& n) {
    const T size = abs(n.x) + abs(n.y) + abs(n.z);
    const Vec2<T> p{n.x / size, n.y / size};
    if (n.z >= T(0)) return p;
    const T x = T(1) - abs(p.y), y = T(1) - abs(p.x);
    return {p.x >= T(0) ? x : -x, p.y >= T(0) ? y : -y};
}

template <class T>
Vec3<T> decode_octahedral(const Vec2<T>& p) {
    const T z = T(1) - abs(p.x) - abs(p.y), fold = max(-z, T(0));
    return normalize(Vec3<T>{p.x >= T(0) ? p.x - fold : p.x + fold, p.y >= T(0) ? p.y - fold : p.y + fold, z});
}

}  // namespace kiln::reference
