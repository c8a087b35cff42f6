#pragma once
// Diffuse light on a curved surface integrated over its scattering, as uber/lib/subsurface_preintegrated.glsl names it:
// the same sums with the same number of steps. With many steps they are the integrals themselves.

#include "uber/reference/fading.h"
#include "uber/reference/subsurface.h"

namespace kiln::reference {

template <class T>
T preintegrated_sine(const T& x) {
    const T y = x * x;
    T series = T(1);
    for (const double k : {110.0, 72.0, 42.0, 20.0, 6.0}) series = T(1) - y / T(k) * series;
    return x * series;
}

// In angles. steps as below.
inline double preintegrated_ring_textbook(double n_dot_l, double curvature, double variance, int steps = 32) {
    const double theta = std::acos(n_dot_l), sigma = std::sqrt(variance) * curvature;
    const double reach = 2 * sigma < 1 ? 2 * std::asin(2 * sigma) : pi;
    double sum = 0, weights = 0;
    for (int i = 0; i < steps; ++i) {
        const double x = reach * ((2.0 * i + 1) / steps - 1), chord = sigma > 0 ? 2 * std::sin(x / 2) / sigma : 0;
        const double weight = std::exp(-chord * chord / 2);
        sum += weight * std::fmax(std::cos(theta + x), 0.0);
        weights += weight;
    }
    return sum / weights;
}
template <class T>
T preintegrated_ring(const T& n_dot_l, const T& curvature, const T& variance, int steps = 32) {
    const T cosine = clamp(n_dot_l, T(-1), T(1)), sine = sqrt((T(1) - cosine) * (T(1) + cosine));
    const T sigma = sqrt(variance) * curvature;
    const T reach = T(2) * sigma < T(1) ? T(2) * asin(T(2) * sigma) : T(pi);
    const T scale = sigma > T(0) ? T(2) / (sigma * sigma) : T(0);
    T sum = T(0), weights = T(0);
    for (int i = 0; i < steps; ++i) {
        const T t = preintegrated_sine(reach * (T(2 * i + 1) / T(steps) - T(1)) / T(2));
        const T weight = fading(-scale * t * t);
        const T cos_x = T(1) - T(2) * t * t, sin_x = T(2) * t * sqrt(max((T(1) - t) * (T(1) + t), T(0)));
        sum = sum + weight * max(cosine * cos_x - sine * sin_x, T(0));
        weights = weights + weight;
    }
    return sum / weights;
}

template <class T>
T burley_gaussian_variance(const T& s) {
    return T(7) / (s * s);
}

// 1/pi of the integral of a + b cos(phi) from 0 to where it meets 0.
inline double circle_of_clamped_cosine_textbook(double cos_theta, double cos_omega) {
    const double a = cos_theta * cos_omega, b = std::sin(std::acos(cos_theta)) * std::sin(std::acos(cos_omega));
    if (b <= std::fabs(a)) return std::fmax(a, 0.0);
    const double phi = std::acos(-a / b);
    return (a * phi + b * std::sin(phi)) / pi;
}
template <class T>
T circle_of_clamped_cosine(const T& cos_theta, const T& cos_omega) {
    const T a = cos_theta * cos_omega;
    const T b2 = max((T(1) - cos_theta) * (T(1) + cos_theta), T(0)) * max((T(1) - cos_omega) * (T(1) + cos_omega), T(0));
    const T root2 = b2 - a * a;
    if (root2 <= T(0)) return max(a, T(0));
    const T root = sqrt(root2);
    return (a * atan(root, -a) + root) / T(pi);
}

template <class T>
T preintegrated_sphere(const T& n_dot_l, const T& curvature_over_s, int steps = 32) {
    const T k = clamp(curvature_over_s, T(1e-6), T(1e6));
    const T whole = burley_cumulative(T(2) / k, T(1));
    T sum = T(0);
    for (int i = 0; i < steps; ++i) {
        const T t = min(burley_radius(whole * (T(i) + T(0.5)) / T(steps), T(1)) * k, T(2));
        sum = sum + circle_of_clamped_cosine(clamp(n_dot_l, T(-1), T(1)), T(1) - t * t / T(2));
    }
    return sum / T(steps);
}

template <class T>
Vec2<T> preintegrated_uv(const T& n_dot_l, const T& curvature_over_s, const Vec2<T>& size) {
    const Vec2<T> t{(T(1) + clamp(n_dot_l, T(-1), T(1))) / T(2), curvature_over_s / (T(1) + curvature_over_s)};
    return {(t.x * (size.x - T(1)) + T(0.5)) / size.x, (t.y * (size.y - T(1)) + T(0.5)) / size.y};
}

template <class T>
T preintegrated_texel(int x, int y, int width, int height, int steps = 32) {
    const T row = T(y) / T(height - 1);
    return preintegrated_sphere(T(2) * T(x) / T(width - 1) - T(1), row / max(T(1) - row, T(1e-6)), steps);
}

// table: (uv) -> T, filtered linearly.
template <class T, class F>
Vec3<T> preintegrated_lookup(F table, const Vec2<T>& size, const T& n_dot_l, const T& curvature, const Vec3<T>& s) {
    return map(s, [&](const T& shape) { return table(preintegrated_uv(n_dot_l, curvature / shape, size)); });
}

}  // namespace kiln::reference
