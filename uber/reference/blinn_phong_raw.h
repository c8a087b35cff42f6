#pragma once
// Blinn-Phong without normalisation, as uber/lib/blinn_phong_raw.glsl names it.

#include "uber/reference/numbers.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

template <class T>
T phong_power(const T& x, const T& p) {
    return p > T(0) ? pow(max(x, T(0)), min(p, T(2048))) : T(1);
}

// Times n.l.
template <class T>
Vec3<T> blinn_phong_raw(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& diffuse, const Vec3<T>& specular,
                        const T& shininess) {
    const Vec3<T> h = safe_normalize(v + l, n);
    return (diffuse / T(pi) + specular * phong_power(dot(n, h), shininess)) * saturate(dot(n, l));
}

}  // namespace kiln::reference
