#pragma once
// The sRGB transfer functions (IEC 61966-2-1), as uber/lib/color.glsl names them.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T srgb_encode(const T& x) {
    const T y = max(x, T(0));
    return y <= T(0.0031308) ? T(12.92) * y : T(1.055) * pow(y, T(1 / 2.4)) - T(0.055);
}
template <class T>
Vec3<T> srgb_encode(const Vec3<T>& x) {
    return map(x, [](const T& c) { return srgb_encode(c); });
}

template <class T>
T srgb_decode(const T& x) {
    const T y = max(x, T(0));
    return y <= T(0.04045) ? y / T(12.92) : pow((y + T(0.055)) / T(1.055), T(2.4));
}
template <class T>
Vec3<T> srgb_decode(const Vec3<T>& x) {
    return map(x, [](const T& c) { return srgb_decode(c); });
}

}  // namespace kiln::reference
