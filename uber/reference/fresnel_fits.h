#pragma once
// Fits of Fresnel's equations, as uber/lib/fresnel_fits.glsl names them.

#include "uber/reference/fresnel.h"

namespace kiln::reference {

template <class T>
Vec3<T> fresnel_schlick_f90(const T& cosine, const Vec3<T>& f0, const Vec3<T>& f90) {
    const T x = T(1) - saturate(cosine);
    return f0 + (f90 - f0) * (x * x * x * x * x);
}

template <class T>
Vec3<T> fresnel_schlick_pow(const T& cosine, const Vec3<T>& f0) {
    return f0 + (splat3(fresnel_f90(f0)) - f0) * pow(T(1) - saturate(cosine), T(5));
}

// Karis 2013.
template <class T>
Vec3<T> fresnel_spherical_gaussian(const T& cosine, const Vec3<T>& f0) {
    const T c = saturate(cosine);
    return f0 + (splat3(fresnel_f90(f0)) - f0) * exp2((T(-5.55473) * c - T(6.98316)) * c);
}

// Lazanyi and Szirmay-Kalos 2005; Hoffman 2019. f82: the reflectance at cosine 1/7.
template <class T>
Vec3<T> fresnel_f82(const T& cosine, const Vec3<T>& f0, const Vec3<T>& f82) {
    const double ratio = 6.0 / 7.0, power5 = ratio * ratio * ratio * ratio * ratio;
    const T c = saturate(cosine), x = T(1) - c;
    const T x5 = x * x * x * x * x;
    const Vec3<T> white = splat3(T(1));
    const Vec3<T> dip = (f0 + (white - f0) * T(power5) - f82) * T(7 / (power5 * ratio));
    return saturate(f0 + (white - f0) * x5 - dip * (c * x5 * x));
}

template <class T>
Vec3<T> fresnel_schlick_pushed(const T& cosine, const Vec3<T>& f0) {
    return max(fresnel_schlick(cosine, f0), splat3(T(0)));
}

}  // namespace kiln::reference
