#pragma once
// Fresnel's equations, as uber/lib/fresnel_exact.glsl names them. Written with the conjugates multiplied out, since the plain
// differences lose digits also in double; the tests hold them against complex arithmetic.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T dielectric_f0(const T& ior) {
    const T r = (ior - T(1)) / (ior + T(1));
    return r * r;
}

template <class T>
T dielectric_ior(const T& f0) {
    const T r = sqrt(clamp(f0, T(0), T(0.999)));
    return (T(1) + r) / (T(1) - r);
}

// cosine: any, limited to [0, 1]; ior: positive.
template <class T>
T fresnel_dielectric(const T& cosine, const T& ior) {
    const T c = saturate(cosine);
    const T contrast = (ior - T(1)) * (ior + T(1));
    const T g2 = contrast + c * c;
    if (value(g2) < 0) return T(1);
    const T g = sqrt(max(g2, T(0)));
    const T n2 = ior * ior;
    const T s = c + g, p = n2 * c + g;
    const T rs = contrast / max(s * s, T(1e-30));
    const T rp = contrast * (c * c * (n2 + T(1)) - T(1)) / max(p * p, T(1e-30));
    return T(0.5) * (rs * rs + rp * rp);
}

// cosine: any, limited to [0, 1]; eta, k: not negative, not both 0.
template <class T>
T fresnel_conductor(const T& cosine, const T& eta, const T& k) {
    const T c = saturate(cosine);
    const T sin2 = (T(1) - c) * (T(1) + c);
    const T t = (eta - k) * (eta + k) - sin2;
    const T product = T(2) * eta * k;
    const T s = sqrt(t * t + product * product);
    const T a2 = value(t) < 0 ? T(0.5) * product * product / max(s - t, T(1e-30)) : T(0.5) * (s + t);
    const T crossed = T(2) * sqrt(a2) * c;
    const T rs = (s + c * c - crossed) / max(s + c * c + crossed, T(1e-30));
    const T p = c * c * s + sin2 * sin2;
    return T(0.5) * rs * (T(1) + (p - crossed * sin2) / max(p + crossed * sin2, T(1e-30)));
}
template <class T>
Vec3<T> fresnel_conductor(const T& cosine, const Vec3<T>& eta, const Vec3<T>& k) {
    return {fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y), fresnel_conductor(cosine, eta.z, k.z)};
}

}  // namespace kiln::reference
