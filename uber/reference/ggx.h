#pragma once
// The GGX microfacet terms, as uber/lib/ggx.glsl names them. Trowbridge and Reitz 1975; Walter et al. 2007; Heitz 2014.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// alpha of a perceptual roughness, which is limited to [0.045, 1].
template <class T>
T ggx_alpha(const T& roughness) {
    const T r = clamp(roughness, T(0.045), T(1));
    return r * r;
}

// D for the angle between unit n and h. Over |h - n|, whose square is 2 - 2 n.h for unit vectors: the only form that is
// well conditioned for vectors which fp32 has rounded, and so the definition for those.
template <class T>
T ggx_distribution(const Vec3<T>& n, const Vec3<T>& h, const T& alpha) {
    const Vec3<T> d = h - n;
    const T c = dot(d, d);
    const T cosine = T(1) - T(0.5) * c, sine_squared = c * (T(1) - T(0.25) * c);
    const T across = alpha * cosine;
    const T k = alpha / (sine_squared + across * across);
    return k * k / T(pi);
}

// The textbook form over the cosine. Double only: 1 - (n.h)^2 cancels.
inline double ggx_distribution_textbook(double n_dot_h, double alpha) {
    const double a2 = alpha * alpha, d = n_dot_h * n_dot_h * (a2 - 1) + 1;
    return a2 / (pi * d * d);
}

// Smith's Lambda (Heitz 2014, equation 72).
inline double ggx_lambda(double cosine, double alpha) {
    const double tangent_squared = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tangent_squared) - 1) / 2;
}

// G2 / (4 n.l n.v), height correlated.
template <class T>
T ggx_visibility(const T& n_dot_l, const T& n_dot_v, const T& alpha) {
    const T a2 = alpha * alpha;
    const T v = n_dot_l * sqrt(n_dot_v * n_dot_v * (T(1) - a2) + a2);
    const T l = n_dot_v * sqrt(n_dot_l * n_dot_l * (T(1) - a2) + a2);
    return T(0.5) / (v + l);
}

// The same from Smith's Lambda: G2 = 1 / (1 + Lambda(l) + Lambda(v)).
inline double ggx_visibility_textbook(double n_dot_l, double n_dot_v, double alpha) {
    return 1 / (1 + ggx_lambda(n_dot_l, alpha) + ggx_lambda(n_dot_v, alpha)) / (4 * n_dot_l * n_dot_v);
}

}  // namespace kiln::reference
