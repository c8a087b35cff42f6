#pragma once
// Sampling for the bakes, as uber/lib/ibl_bake.glsl and lecture_ibl.glsl name it. The integrals themselves are
// split_sum_quadrature.h and skies.h.

#include <cstdint>

#include "uber/reference/ggx.h"

namespace kiln::reference {

// Digits of i in base 2 mirrored at the point, 24 of them.
inline double radical_inverse(uint32_t i) {
    double sum = 0;
    for (int bit = 0; bit < 24; ++bit) sum += (i >> bit & 1) * std::ldexp(1.0, -1 - bit);
    return sum;
}
inline Vec2<double> hammersley(uint32_t i, uint32_t count) { return {static_cast<double>(i) / count, radical_inverse(i)}; }

// Duff et al. 2017: columns tangent, bitangent, n.
template <class T>
Mat3<T> frame_around(const Vec3<T>& n) {
    const T s = value(n.z) < 0.0 ? T(-1) : T(1);
    const T a = T(-1) / (s + n.z), b = n.x * n.y * a;
    return {{{T(1) + s * n.x * n.x * a, s * b, -s * n.x}, {b, s + n.y * n.y * a, -n.y}, n}};
}

template <class T>
Vec3<T> sample_cosine(const Vec2<T>& u) {
    const Vec2<T> p = cos_sin_of_turn(u.y) * -sqrt(u.x);
    return {p.x, p.y, sqrt(max(T(1) - u.x, T(0)))};
}

// Walter et al. 2007, equation 35: theta = atan(alpha sqrt(u / (1 - u))).
template <class T>
Vec3<T> sample_ggx_half(const Vec2<T>& u, const T& alpha) {
    const T tangent = alpha * sqrt(u.x / max(T(1) - u.x, T(1e-7)));
    const T cosine = inversesqrt(T(1) + tangent * tangent), sine = tangent * cosine;
    const Vec2<T> p = cos_sin_of_turn(u.y) * -sine;
    return {p.x, p.y, cosine};
}

// 0.5 log2 of the sample's solid angle over the texel's.
template <class T>
T filtered_lod(const T& pdf, const T& count, const T& size) {
    const T sample = T(1) / (count * max(pdf, T(1e-20))), texel = T(4.0 * pi) / (T(6) * size * size);
    return max(T(0.5) * log2(sample / texel), T(0));
}

// Mean over the same points as the shader's. visibility(n.l, n.v): G2 / (4 n.l n.v); fresnel_weight(n.l, v.h).
template <class V, class F>
Vec2<double> split_sum_sampled(double n_dot_v, double alpha, uint32_t count, V visibility, F fresnel_weight) {
    const double cosine = std::clamp(n_dot_v, 1e-4, 1.0);
    const Vec3<double> v{std::sqrt(1.0 - cosine * cosine), 0.0, cosine};
    Vec2<double> sum;
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3<double> h = sample_ggx_half(hammersley(i, count), alpha);
        const double v_dot_h = dot(v, h), n_dot_l = 2.0 * v_dot_h * h.z - cosine;
        if (n_dot_l <= 0.0) continue;
        const double fc = fresnel_weight(n_dot_l, v_dot_h);
        sum = sum + Vec2<double>{1.0 - fc, fc} * (4.0 * visibility(n_dot_l, cosine) * n_dot_l * v_dot_h / h.z);
    }
    return sum / static_cast<double>(count);
}

}  // namespace kiln::reference
