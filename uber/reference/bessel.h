#pragma once
// Modified Bessel functions of order 0, scaled: exp(-x) I0(x) and exp(x) K0(x), as uber/lib/bessel.glsl names them. Here
// by the standard library where the plain product is in range and by Hankel's expansion beyond.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// Hankel's expansion of sqrt(2 pi x) exp(-x) I0(x) (sign -1) and of sqrt(2 x / pi) exp(x) K0(x) (sign +1):
// sum of (-sign)^k (1 3 5 ... (2k-1))^2 / (k! (8x)^k), good to 1e-16 from x = 100 on.
inline double hankel_order_0(double x, double sign) {
    double sum = 1, term = 1;
    for (int k = 1; k < 12; ++k) {
        term *= -sign * (2.0 * k - 1) * (2.0 * k - 1) / (k * 8.0 * x);
        sum += term;
    }
    return sum;
}

template <class T>
T bessel_i0_scaled(const T& x) {
    const double d = value(x);
    return T(d < 200 ? std::cyl_bessel_i(0.0, d) * std::exp(-d) : hankel_order_0(d, -1) / std::sqrt(2 * pi * d));
}

template <class T>
T bessel_k0_scaled(const T& x) {
    const double d = value(x);
    return T(d < 200 ? std::cyl_bessel_k(0.0, d) * std::exp(d) : hankel_order_0(d, 1) * std::sqrt(pi / (2 * d)));
}

}  // namespace kiln::reference
