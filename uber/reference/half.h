#pragma once
// fp16 as a number type for the templates: every operation in fp32, then rounded to the nearest fp16, ties to even. For + -
// * / and sqrt that is the correctly rounded result, as 24 bits hold more than twice 11.

#include <cmath>
#include <limits>

#include "uber/reference/numbers.h"

namespace kiln::reference {

// Overflows to infinity from 65520 on; below 2^-14 the step is 2^-24.
inline float round_to_half(float x) {
    if (!std::isfinite(x) || x == 0) return x;
    if (std::fabs(x) >= 65520.0f) return std::copysign(std::numeric_limits<float>::infinity(), x);
    int exponent = 0;
    std::frexp(x, &exponent);
    const int step = std::max(exponent - 11, -24);
    return std::ldexp(std::nearbyint(std::ldexp(x, -step)), step);
}

struct Half {
    float v = 0;
    Half() = default;
    explicit Half(double x) : v(round_to_half(static_cast<float>(x))) {}
    explicit Half(float x) : v(round_to_half(x)) {}
    explicit Half(int x) : Half(static_cast<float>(x)) {}
};

inline double value(Half x) { return static_cast<double>(x.v); }
inline Half operator-(Half a) { return Half(-a.v); }
inline Half operator+(Half a, Half b) { return Half(a.v + b.v); }
inline Half operator-(Half a, Half b) { return Half(a.v - b.v); }
inline Half operator*(Half a, Half b) { return Half(a.v * b.v); }
inline Half operator/(Half a, Half b) { return Half(a.v / b.v); }
inline bool operator<(Half a, Half b) { return a.v < b.v; }
inline bool operator>(Half a, Half b) { return a.v > b.v; }
inline bool operator<=(Half a, Half b) { return a.v <= b.v; }
inline bool operator>=(Half a, Half b) { return a.v >= b.v; }
inline bool operator==(Half a, Half b) { return a.v == b.v; }
inline Half abs(Half x) { return Half(std::fabs(x.v)); }
inline Half sqrt(Half x) { return Half(std::sqrt(x.v)); }
inline Half inversesqrt(Half x) { return Half(1.0f / std::sqrt(x.v)); }
inline Half pow(Half x, Half y) { return Half(std::pow(x.v, y.v)); }
inline Half min(Half a, Half b) { return Half(std::fmin(a.v, b.v)); }
inline Half max(Half a, Half b) { return Half(std::fmax(a.v, b.v)); }

}  // namespace kiln::reference
