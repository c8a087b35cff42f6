#pragma once
// Fresnel reflectance, as uber/lib/fresnel.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// Lagarde and de Rousiers 2014: below 2 % a specular colour means no highlight.
template <class T>
T fresnel_f90(const Vec3<T>& f0) {
    return saturate(T(50) * dot(f0, splat3(T(0.33))));
}

// Schlick 1994. cosine: any; limited to [0, 1].
template <class T>
Vec3<T> fresnel_schlick(const T& cosine, const Vec3<T>& f0) {
    const T x = T(1) - saturate(cosine);
    return f0 + (splat3(fresnel_f90(f0)) - f0) * (x * x * x * x * x);
}

// 2 integral of fresnel_schlick(m) m dm over [0, 1].
template <class T>
Vec3<T> fresnel_average(const Vec3<T>& f0) {
    return f0 + (splat3(fresnel_f90(f0)) - f0) / T(21);
}

}  // namespace kiln::reference
