#pragma once
// Exposure and tone curves, as uber/lib/tonemap.glsl names them.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T luminance(const Vec3<T>& c) {
    return T(0.2126) * c.x + T(0.7152) * c.y + T(0.0722) * c.z;
}

// A sensor of ISO 100 saturates at 1.2 2^ev cd/m2.
template <class T>
T exposure_from_ev100(const T& ev) {
    return T(1) / (T(1.2) * exp2(ev));
}

// A meter sets 2^ev = 100 / 12.5 L.
template <class T>
T exposure_from_mean(const T& mean) {
    return T(1) / (T(1.2) * (T(8) * max(mean, T(1e-6))));
}

template <class T>
Vec3<T> limit_half(const Vec3<T>& c) {
    return map(c, [](const T& x) { return clamp(x, T(0), T(65504)); });
}

// x / (1 + x), for finite x.
template <class T>
T tone_reinhard(const T& x) {
    const T y = max(x, T(0));
    return y / (T(1) + y);
}
template <class T>
Vec3<T> tone_reinhard(const Vec3<T>& c) {
    return map(c, [](const T& x) { return tone_reinhard(x); });
}

// The colour at the luminance L (1 + L / white^2) / (1 + L), at most 1 a channel.
template <class T>
Vec3<T> tone_reinhard_white(const Vec3<T>& c, const T& white) {
    const Vec3<T> x = limit_half(c);
    const T l = luminance(x), w = max(white, T(1));
    const T scale = (T(1) + l / (w * w)) / (T(1) + l);
    return min(x * scale, splat3(T(1)));
}

template <class T>
T tone_aces(const T& x) {
    const T y = clamp(x, T(0), T(8));
    return saturate(y * (T(2.51) * y + T(0.03)) / (y * (T(2.43) * y + T(0.59)) + T(0.14)));
}
template <class T>
Vec3<T> tone_aces(const Vec3<T>& c) {
    return map(c, [](const T& x) { return tone_aces(x); });
}

}  // namespace kiln::reference
