#pragma once
// Separable subsurface scattering, as uber/lib/subsurface_separable.glsl names it.

#include <vector>

#include "uber/reference/bessel.h"
#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T separable_offset(int i, int n, const T& range) {
    const T t = T(2 * i - (n - 1)) / T(n - 1);
    return range * t * abs(t);
}

template <class T>
Vec3<T> separable_skin_profile(const T& r, const Vec3<T>& falloff) {
    const double weights[] = {0.100, 0.118, 0.113, 0.358, 0.078};
    const double variances[] = {0.0484, 0.187, 0.567, 1.99, 7.41};
    return map(falloff, [&](const T& f) {
        const T q = r / max(f, T(1e-3));
        T sum = T(0);
        for (int k = 0; k < 5; ++k) sum = sum + T(weights[k]) * exp(-q * q / T(2 * variances[k])) / T(2 * pi * variances[k]);
        return sum;
    });
}

// xyz the weights, w the offset.
template <class T>
std::vector<Vec4<T>> separable_kernel_skin(const Vec3<T>& falloff, const Vec3<T>& strength, int taps = 17) {
    const T range = T(taps > 20 ? 3 : 2);
    std::vector<Vec4<T>> kernel;
    Vec3<T> sum = splat3(T(0));
    for (int i = 0; i < taps; ++i) {
        const T at = separable_offset(i, taps, range);
        const T before = i > 0 ? at - separable_offset(i - 1, taps, range) : T(0);
        const T after = i + 1 < taps ? separable_offset(i + 1, taps, range) - at : T(0);
        const Vec3<T> w = separable_skin_profile(at, falloff) * ((before + after) / T(2));
        kernel.push_back({w.x, w.y, w.z, at});
        sum = sum + w;
    }
    for (int i = 0; i < taps; ++i) {
        Vec4<T>& k = kernel[static_cast<std::size_t>(i)];
        Vec3<T> w = k.xyz() / sum * strength;
        if (2 * i == taps - 1) w = w + (splat3(T(1)) - strength);
        k = {w.x, w.y, w.z, k.w};
    }
    return kernel;
}

template <class T>
T burley_line_spread(const T& x, const T& s) {
    const auto k0 = [](const T& y) { return bessel_k0_scaled(y) * exp(-y); };
    return s * (k0(s * x) + k0(s * x / T(3))) / T(4 * pi);
}

// points: midpoints a cell; the GLSL takes 4.
template <class T>
std::vector<Vec4<T>> separable_kernel_burley(const Vec3<T>& s, const T& range, int taps = 17, int points = 4) {
    std::vector<Vec4<T>> kernel;
    Vec3<T> sum = splat3(T(0));
    for (int i = 0; i < taps; ++i) {
        Vec3<T> w = splat3(T(0));
        for (int j = 0; j < points; ++j) {
            const T t = abs(T(2) * (T(i) + (T(j) + T(0.5)) / T(points) - T(0.5)) / T(taps - 1) - T(1));
            w = w + map(s, [&](const T& shape) { return burley_line_spread(range * t * t, shape); }) * t;
        }
        kernel.push_back({w.x, w.y, w.z, separable_offset(i, taps, range)});
        sum = sum + w;
    }
    for (Vec4<T>& k : kernel) k = {k.x / sum.x, k.y / sum.y, k.z / sum.z, k.w};
    return kernel;
}

// irradiance: (uv) -> Vec3.
template <class T, class F>
Vec3<T> separable_gather(F irradiance, const Vec2<T>& uv, const Vec2<T>& axis, const std::vector<Vec4<T>>& kernel) {
    Vec3<T> sum = splat3(T(0));
    for (const Vec4<T>& k : kernel) sum = sum + k.xyz() * irradiance(uv + axis * k.w);
    return sum;
}

}  // namespace kiln::reference
