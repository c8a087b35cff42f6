#pragma once
// Punctual lights, as uber/lib/lights.glsl names them. Lagarde and de Rousiers 2014; Karis 2013.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// 1 / d^2, flat within 1 cm, times sat(1 - (d / range)^4)^2. Takes d^2.
template <class T>
T distance_attenuation(const T& distance_squared, const T& range) {
    const T ratio = distance_squared / max(range * range, T(1e-12));
    const T window = saturate(T(1) - ratio * ratio);
    return window * window / max(distance_squared, T(1e-4));
}

// sat((c - outer) / (inner - outer))^2, the difference no smaller than 1e-3.
template <class T>
T cone_attenuation(const T& cos_angle, const T& cos_inner, const T& cos_outer) {
    const T t = saturate((cos_angle - cos_outer) / max(cos_inner - cos_outer, T(1e-3)));
    return t * t;
}

// Candela from lumen: a point light's flux / 4 pi, a spot light's flux / pi whatever its angle.
template <class T>
T point_light_intensity(const T& lumen) {
    return lumen * T(0.25 / pi);
}
template <class T>
T spot_light_intensity(const T& lumen) {
    return lumen * T(1.0 / pi);
}

}  // namespace kiln::reference
