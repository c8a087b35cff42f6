#pragma once
// Modified Bessel functions of order 0, scaled: exp(-x) I0(x) and exp(x) K0(x), as uber/lib/bessel.glsl names them, and
// as textbook forms by the standard library where the plain product is in range, by Hankel's expansion beyond.

#include "uber/reference/numbers.h"

namespace kiln::reference {

namespace bessel {

// Abramowitz and Stegun 9.8.1: I0(x) for |x| <= 3.75, t = (x / 3.75)^2.
template <class T>
T i0_near(const T& t) {
    const double c[] = {0.0045813, 0.0360768, 0.2659732, 1.2067492, 3.0899424, 3.5156229, 1};
    T sum = T(0);
    for (const double k : c) sum = sum * t + T(k);
    return sum;
}

}  // namespace bessel

template <class T>
T bessel_i0_scaled(const T& x) {
    if (x < T(3.75)) {
        const T t = x / T(3.75);
        return bessel::i0_near(t * t) * exp(-x);
    }
    const double c[] = {0.00392377,  -0.01647633, 0.02635537, -0.02057706, 0.00916281,
                        -0.00157565, 0.00225319,  0.01328592, 0.39894228};
    const T u = T(3.75) / x;
    T sum = T(0);
    for (const double k : c) sum = sum * u + T(k);
    return sum * inversesqrt(x);
}

template <class T>
T bessel_k0_scaled(const T& x) {
    if (x <= T(2)) {
        const double c[] = {0.00000740, 0.00010750, 0.00262698, 0.03488590, 0.23069756, 0.42278420, -0.57721566};
        const T h = x / T(2);
        T sum = T(0);
        for (const double k : c) sum = sum * (h * h) + T(k);
        return (sum - log(max(h, T(1e-37))) * bessel::i0_near(x * x / T(14.0625))) * exp(x);
    }
    const double c[] = {0.00053208, -0.00251540, 0.00587872, -0.01062446, 0.02189568, -0.07832358, 1.25331414};
    const T u = T(2) / x;
    T sum = T(0);
    for (const double k : c) sum = sum * u + T(k);
    return sum * inversesqrt(x);
}

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
T bessel_i0_scaled_textbook(const T& x) {
    const double d = value(x);
    return T(d < 200 ? std::cyl_bessel_i(0.0, d) * std::exp(-d) : hankel_order_0(d, -1) / std::sqrt(2 * pi * d));
}

template <class T>
T bessel_k0_scaled_textbook(const T& x) {
    const double d = value(x);
    return T(d < 200 ? std::cyl_bessel_k(0.0, d) * std::exp(d) : hankel_order_0(d, 1) * std::sqrt(pi / (2 * d)));
}

}  // namespace kiln::reference
