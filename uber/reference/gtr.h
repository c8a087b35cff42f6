#pragma once
// GTR1, as uber/lib/gtr.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// -ln(1 - u) / u. The series of 2 atanh(z) / u, z = u / (2 - u), is summed as far as the shader sums it, so that its running
// error is that of the shader; it is off by 2e-8.
template <class T>
T log_ratio(const T& u) {
    if (!(value(u) < 0.25)) return -log(T(1) - u) / u;
    const T z = u / (T(2) - u), z2 = z * z;
    return T(2) / (T(2) - u) * (T(1) + z2 * (T(1) / T(3) + z2 * (T(1) / T(5) + z2 / T(7))));
}

template <class T>
T gtr1_distribution(const Vec3<T>& n, const Vec3<T>& h, const T& alpha) {
    const Vec3<T> d = h - n;
    const T c = dot(d, d);
    const T u = (T(1) - alpha) * (T(1) + alpha);
    const T ratio = value(u) < 0.25 ? log_ratio(u) : T(-2) * log(alpha) / u;
    return T(1) / (T(pi) * ratio * (alpha * alpha + u * (c * (T(1) - T(0.25) * c))));
}

}  // namespace kiln::reference
