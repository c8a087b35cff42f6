#pragma once
// Normalised Blinn-Phong, as uber/lib/blinn_phong.glsl names it. Blinn 1977; Giesen 2009; Walter et al. 2007.

#include "uber/reference/vectors.h"

namespace kiln::reference {

// The inverse of the integral of (n.h)^p n.l over the hemisphere at v = n.
template <class T>
T blinn_phong_normalization(const T& shininess) {
    return (shininess + T(2)) * (shininess + T(4)) / (T(8) * T(pi) * (exp2(T(-0.5) * shininess) + shininess));
}

// The root of alpha = sqrt(2 / (p + 2)).
template <class T>
T blinn_phong_roughness(const T& shininess) {
    return sqrt(sqrt(T(2) / (shininess + T(2))));
}

template <class T>
T blinn_phong_shininess(const T& roughness) {
    const T r2 = roughness * roughness;
    return clamp(T(2) / max(r2 * r2, T(1e-6)) - T(2), T(1), T(2048));
}

// (kd (1 - max ks) / pi + ks c (n.h)^p) n.l, p limited to [1, 2048].
template <class T>
Vec3<T> blinn_phong(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& diffuse, const Vec3<T>& specular,
                    const T& shininess) {
    const T n_dot_l = saturate(dot(n, l));
    const Vec3<T> h = safe_normalize(v + l, n);
    const T p = clamp(shininess, T(1), T(2048));
    const T lobe = blinn_phong_normalization(p) * pow(saturate(dot(n, h)), p);
    return (diffuse * ((T(1) - max_component(specular)) / T(pi)) + specular * lobe) * n_dot_l;
}

}  // namespace kiln::reference
