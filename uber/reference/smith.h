#pragma once
// Smith's masking for GGX and its stand-ins, as uber/lib/smith.glsl names them. Lambda and G1 have the conjugate multiplied
// out: (sqrt(1 + q) - 1) / 2 is of no use for q below 1e-15, in double either. The tests hold them against the plain forms.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// sqrt(c^2 + alpha^2 (1 - c^2)).
template <class T>
T smith_root(const T& c, const T& alpha) {
    return sqrt(c * c + alpha * alpha * ((T(1) - c) * (T(1) + c)));
}

template <class T>
T smith_lambda(const T& c, const T& alpha) {
    return alpha * alpha * ((T(1) - c) * (T(1) + c)) / (T(2) * c * (c + smith_root(c, alpha)));
}

template <class T>
T smith_g1(const T& c, const T& alpha) {
    return T(2) * c / (c + smith_root(c, alpha));
}

template <class T>
T visibility_separable(const T& n_dot_l, const T& n_dot_v, const T& alpha) {
    return T(1) / ((n_dot_l + smith_root(n_dot_l, alpha)) * (n_dot_v + smith_root(n_dot_v, alpha)));
}

template <class T>
T visibility_height_correlated_pushed(const T& n_dot_l, const T& n_dot_v, const T& alpha) {
    return T(0.5) / (n_dot_l * smith_root(n_dot_v, alpha) + n_dot_v * smith_root(n_dot_l, alpha));
}

template <class T>
T visibility_schlick(const T& n_dot_l, const T& n_dot_v, const T& k) {
    return T(0.25) / ((n_dot_l * (T(1) - k) + k) * (n_dot_v * (T(1) - k) + k));
}

template <class T>
T visibility_karis_ibl(const T& n_dot_l, const T& n_dot_v, const T& alpha) {
    return visibility_schlick(n_dot_l, n_dot_v, alpha / T(2));
}

template <class T>
T visibility_karis_direct(const T& n_dot_l, const T& n_dot_v, const T& roughness) {
    return visibility_schlick(n_dot_l, n_dot_v, (roughness + T(1)) * (roughness + T(1)) / T(8));
}

// Hammon 2017.
template <class T>
T visibility_hammon(const T& n_dot_l, const T& n_dot_v, const T& alpha) {
    return T(0.5) / mix(T(2) * n_dot_l * n_dot_v, n_dot_l + n_dot_v, alpha);
}

// Kelemen and Szirmay-Kalos 2001.
template <class T>
T visibility_kelemen(const T& v_dot_h) {
    const T c = max(v_dot_h, T(1e-4));
    return T(0.25) / (c * c);
}

template <class T>
T visibility_implicit() {
    return T(0.25);
}

}  // namespace kiln::reference
