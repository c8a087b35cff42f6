#pragma once
// The GGX distribution from sine and cosine, as uber/lib/ggx_forms.glsl names them.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T ggx_from_sine(const T& cosine, const T& sine2, const T& alpha) {
    const T k = alpha / (sine2 + alpha * cosine * (alpha * cosine));
    return k * k / T(pi);
}

template <class T>
T ggx_distribution_cross(const Vec3<T>& n, const Vec3<T>& h, const T& alpha) {
    const Vec3<T> across = cross(n, h);
    return ggx_from_sine(dot(n, h), dot(across, across), alpha);
}

template <class T>
T ggx_distribution_cosine(const T& n_dot_h, const T& alpha) {
    const T c = saturate(n_dot_h);
    return ggx_from_sine(c, (T(1) - c) * (T(1) + c), alpha);
}

}  // namespace kiln::reference
