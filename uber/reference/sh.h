#pragma once
// Spherical harmonics as uber/lib/sh.glsl and lecture_sh.glsl name them, in textbook form: constants from their roots,
// convolution by its eigenvalues and evaluation by the sum over the basis, never merged.

#include <array>

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
struct ShMomentsL1 {
    Vec3<T> m0, m1_y, m1_z, m1_x;
};
template <class T>
struct ShWeightedL1 {
    Vec3<T> w0, w1_y, w1_z, w1_x;
};
template <class T>
struct ShL1 {
    std::array<Vec3<T>, 4> c;
};
template <class T>
struct ShL2 {
    std::array<Vec3<T>, 9> c;
};
template <class T>
struct ShIrradianceL1 {
    std::array<Vec3<T>, 4> e;
};
template <class T>
struct ShIrradianceL2 {
    std::array<Vec3<T>, 9> e;
};

inline constexpr std::array<int, 9> sh_band{0, 1, 1, 1, 2, 2, 2, 2, 2};

// The nine functions, in the order 1, y, z, x, xy, yz, 3 z^2 - 1, xz, x^2 - y^2.
template <class T>
std::array<T, 9> sh_l2_basis(const Vec3<T>& p) {
    const T y0 = T(std::sqrt(1.0 / (4.0 * pi))), y1 = T(std::sqrt(3.0 / (4.0 * pi))), y2 = T(std::sqrt(15.0 / (4.0 * pi)));
    const T y2_z = T(std::sqrt(5.0 / (16.0 * pi))), y2_x = T(std::sqrt(15.0 / (16.0 * pi)));
    return {y0,
            y1 * p.y,
            y1 * p.z,
            y1 * p.x,
            y2 * p.x * p.y,
            y2 * p.y * p.z,
            y2_z * (T(3) * p.z * p.z - T(1)),
            y2 * p.x * p.z,
            y2_x * (p.x * p.x - p.y * p.y)};
}
template <class T>
Vec4<T> sh_l1_basis(const Vec3<T>& p) {
    const std::array<T, 9> y = sh_l2_basis(p);
    return {y[0], y[1], y[2], y[3]};
}
template <class T>
Vec4<T> sh_band2_basis(const Vec3<T>& p) {
    const std::array<T, 9> y = sh_l2_basis(p);
    return {y[4], y[5], y[6], y[7]};
}
template <class T>
T sh_band2_basis_last(const Vec3<T>& p) {
    return sh_l2_basis(p)[8];
}

// pi, 2 pi/3, pi/4.
inline double sh_cosine_eigenvalue(int band) { return band == 0 ? pi : band == 1 ? 2.0 * pi / 3.0 : pi / 4.0; }

template <class T>
ShMomentsL1<T> sh_moments_accumulate(const ShMomentsL1<T>& sum, const Vec3<T>& d, const Vec3<T>& radiance, const T& sr) {
    return {sum.m0 + radiance * sr, sum.m1_y + radiance * (sr * d.y), sum.m1_z + radiance * (sr * d.z),
            sum.m1_x + radiance * (sr * d.x)};
}
template <class T>
ShL1<T> sh_l1_accumulate(ShL1<T> sum, const Vec3<T>& d, const Vec3<T>& radiance, const T& sr) {
    const std::array<T, 9> y = sh_l2_basis(d);
    for (size_t i = 0; i < 4; ++i) sum.c[i] = sum.c[i] + radiance * (sr * y[i]);
    return sum;
}
template <class T>
ShL2<T> sh_l2_accumulate(ShL2<T> sum, const Vec3<T>& d, const Vec3<T>& radiance, const T& sr) {
    const std::array<T, 9> y = sh_l2_basis(d);
    for (size_t i = 0; i < 9; ++i) sum.c[i] = sum.c[i] + radiance * (sr * y[i]);
    return sum;
}

template <class T>
ShMomentsL1<T> sh_moments_of(const ShL1<T>& sh) {
    const T y0 = T(std::sqrt(1.0 / (4.0 * pi))), y1 = T(std::sqrt(3.0 / (4.0 * pi)));
    return {sh.c[0] / y0, sh.c[1] / y1, sh.c[2] / y1, sh.c[3] / y1};
}
template <class T>
ShL1<T> sh_l1_of(const ShMomentsL1<T>& m) {
    const T y0 = T(std::sqrt(1.0 / (4.0 * pi))), y1 = T(std::sqrt(3.0 / (4.0 * pi)));
    return {{m.m0 * y0, m.m1_y * y1, m.m1_z * y1, m.m1_x * y1}};
}

template <class T>
ShIrradianceL1<T> sh_l1_convolve(const ShL1<T>& sh) {
    ShIrradianceL1<T> out;
    for (size_t i = 0; i < 4; ++i) out.e[i] = sh.c[i] * T(sh_cosine_eigenvalue(sh_band[i]));
    return out;
}
template <class T>
ShIrradianceL2<T> sh_l2_convolve(const ShL2<T>& sh) {
    ShIrradianceL2<T> out;
    for (size_t i = 0; i < 9; ++i) out.e[i] = sh.c[i] * T(sh_cosine_eigenvalue(sh_band[i]));
    return out;
}
// The lobe's weights times both basis constants.
template <class T>
ShWeightedL1<T> sh_l1_weight(const ShMomentsL1<T>& m) {
    const T w0 = T(pi / (4.0 * pi)), w1 = T(2.0 * pi / 3.0 * 3.0 / (4.0 * pi));
    return {m.m0 * w0, m.m1_y * w1, m.m1_z * w1, m.m1_x * w1};
}

template <class T, size_t N>
Vec3<T> sh_sum(const std::array<Vec3<T>, N>& c, const Vec3<T>& p) {
    const std::array<T, 9> y = sh_l2_basis(p);
    Vec3<T> sum = c[0] * y[0];
    for (size_t i = 1; i < N; ++i) sum = sum + c[i] * y[i];
    return sum;
}
template <class T>
Vec3<T> sh_l1_radiance(const ShL1<T>& sh, const Vec3<T>& p) {
    return sh_sum(sh.c, p);
}
template <class T>
Vec3<T> sh_l2_radiance(const ShL2<T>& sh, const Vec3<T>& p) {
    return sh_sum(sh.c, p);
}
template <class T>
Vec3<T> sh_irradiance_convolved(const ShIrradianceL1<T>& sh, const Vec3<T>& n) {
    return sh_sum(sh.e, n);
}
template <class T>
Vec3<T> sh_irradiance_convolved(const ShIrradianceL2<T>& sh, const Vec3<T>& n) {
    return sh_sum(sh.e, n);
}
template <class T>
Vec3<T> sh_irradiance_from_radiance(const ShL1<T>& sh, const Vec3<T>& n) {
    return sh_irradiance_convolved(sh_l1_convolve(sh), n);
}
template <class T>
Vec3<T> sh_irradiance_from_radiance(const ShL2<T>& sh, const Vec3<T>& n) {
    return sh_irradiance_convolved(sh_l2_convolve(sh), n);
}
template <class T>
Vec3<T> sh_irradiance_from_moments(const ShMomentsL1<T>& m, const Vec3<T>& n) {
    return sh_irradiance_from_radiance(sh_l1_of(m), n);
}
template <class T>
Vec3<T> sh_irradiance_from_weighted(const ShWeightedL1<T>& w, const Vec3<T>& n) {
    return w.w0 + w.w1_y * n.y + w.w1_z * n.z + w.w1_x * n.x;
}
template <class T>
Vec3<T> sh_irradiance_clamped(const ShMomentsL1<T>& m, const Vec3<T>& n) {
    return max(sh_irradiance_from_moments(m, n), splat3(T(0)));
}
template <class T>
Vec3<T> sh_irradiance_clamped(const ShL2<T>& sh, const Vec3<T>& n) {
    return max(sh_irradiance_from_radiance(sh, n), splat3(T(0)));
}

// Ramamoorthi and Hanrahan 2001, equation 12, its constants from the eigenvalues.
template <class T>
Mat4<T> sh_quadratic_matrix(const std::array<T, 9>& c) {
    const double y0 = std::sqrt(1.0 / (4.0 * pi)), y1 = std::sqrt(3.0 / (4.0 * pi)), y2_z = std::sqrt(5.0 / (16.0 * pi)),
                 y2_x = std::sqrt(15.0 / (16.0 * pi));
    const T c1 = T(pi / 4.0 * y2_x), c2 = T(pi / 3.0 * y1), c3 = T(3.0 * pi / 4.0 * y2_z), c4 = T(pi * y0),
            c5 = T(pi / 4.0 * y2_z);
    return {{{c1 * c[8], c1 * c[4], c1 * c[7], c2 * c[3]},
             {c1 * c[4], -c1 * c[8], c1 * c[5], c2 * c[1]},
             {c1 * c[7], c1 * c[5], c3 * c[6], c2 * c[2]},
             {c2 * c[3], c2 * c[1], c2 * c[2], c4 * c[0] - c5 * c[6]}}};
}
template <class T>
T sh_quadratic_irradiance(const Mat4<T>& m, const Vec3<T>& n) {
    const Vec4<T> v{n.x, n.y, n.z, T(1)};
    return dot(v, m * v);
}

// Hazel 2017: m0/4 (a + (1 - a)(p + 1) q^p).
template <class T>
T sh_irradiance_nonlinear_channel(const T& m0, const Vec3<T>& m1, const Vec3<T>& n) {
    const T power = max(m0, T(0)), size = length(m1);
    if (value(power) == 0.0) return T(0);
    if (value(size) == 0.0) return power * T(0.25);
    const T k = min(size / power, T(1));
    const T q = (T(1) + dot(m1, n) / size) / T(2), p = T(1) + T(2) * k, a = (T(1) - k) / (T(1) + k);
    return power / T(4) * (a + (T(1) - a) * (p + T(1)) * pow(saturate(q), p));
}
template <class T>
Vec3<T> sh_irradiance_nonlinear(const ShMomentsL1<T>& m, const Vec3<T>& n) {
    return {sh_irradiance_nonlinear_channel(m.m0.x, Vec3<T>{m.m1_x.x, m.m1_y.x, m.m1_z.x}, n),
            sh_irradiance_nonlinear_channel(m.m0.y, Vec3<T>{m.m1_x.y, m.m1_y.y, m.m1_z.y}, n),
            sh_irradiance_nonlinear_channel(m.m0.z, Vec3<T>{m.m1_x.z, m.m1_y.z, m.m1_z.z}, n)};
}

// Roughton et al. 2024: the irradiance of the third band that two orthonormal bands let one guess about an axis.
// c0: orthonormal; along: c1 . axis, of either sign; z: n . axis.
template <class T>
T sh_zh3_band(const T& c0, const T& along, const T& z) {
    const T ratio = min(abs(along) / c0, T(std::sqrt(3.0)));
    const T c2 = c0 * (T(0.08) * ratio + T(0.6) * ratio * ratio);
    return T(sh_cosine_eigenvalue(2)) * c2 * T(std::sqrt(5.0 / (16.0 * pi))) * (T(3) * z * z - T(1));
}
template <class T>
T sh_zh3_zonal(const T& k, const T& z) {
    return sh_zh3_band(T(std::sqrt(1.0 / (4.0 * pi))), k * T(std::sqrt(3.0 / (4.0 * pi))), z);
}
template <class T>
T sh_irradiance_zh3_channel(const T& m0, const Vec3<T>& m1, const Vec3<T>& n) {
    const T power = max(m0, T(0)), size = length(m1);
    if (value(power) == 0.0) return T(0);
    if (value(size) == 0.0) return power * T(0.25);
    const T k = min(size / power, T(1)), z = clamp(dot(m1, n) / size, T(-1), T(1));
    return power * (T(0.25) + T(0.5) * k * z + sh_zh3_zonal(k, z));
}
template <class T>
Vec3<T> sh_irradiance_zh3(const ShMomentsL1<T>& m, const Vec3<T>& n) {
    return {sh_irradiance_zh3_channel(m.m0.x, Vec3<T>{m.m1_x.x, m.m1_y.x, m.m1_z.x}, n),
            sh_irradiance_zh3_channel(m.m0.y, Vec3<T>{m.m1_x.y, m.m1_y.y, m.m1_z.y}, n),
            sh_irradiance_zh3_channel(m.m0.z, Vec3<T>{m.m1_x.z, m.m1_y.z, m.m1_z.z}, n)};
}
template <class T>
Vec3<T> sh_irradiance_zh3_luminance(const ShMomentsL1<T>& m, const Vec3<T>& n) {
    const Vec3<T> luminance{T(0.2126), T(0.7152), T(0.0722)};
    const Vec3<T> sum{dot(m.m1_x, luminance), dot(m.m1_y, luminance), dot(m.m1_z, luminance)};
    const Vec3<T> two = sh_irradiance_from_moments(m, n);
    const T size = length(sum);
    if (value(size) == 0.0) return two;
    const Vec3<T> axis = sum / size;
    const T z = dot(axis, n);
    const auto band = [&](const T& m0, const Vec3<T>& m1) {
        const T power = max(m0, T(0));
        if (value(power) == 0.0) return T(0);
        return power * sh_zh3_zonal(min(abs(dot(m1, axis)) / power, T(1)), z);
    };
    return two + Vec3<T>{band(m.m0.x, Vec3<T>{m.m1_x.x, m.m1_y.x, m.m1_z.x}), band(m.m0.y, Vec3<T>{m.m1_x.y, m.m1_y.y, m.m1_z.y}),
                         band(m.m0.z, Vec3<T>{m.m1_x.z, m.m1_y.z, m.m1_z.z})};
}

// The slides in order, six digits as printed. c: 1, y, z, x.
template <class T>
T sh_irradiance_lecture(const Vec4<T>& c, const Vec3<T>& n) {
    const T y0 = T(0.282095), y1 = T(0.488603), a0 = T(0.886227), a1 = T(1.023326);
    return c.x * a0 * y0 + c.y * a1 * (y1 * n.y) + c.z * a1 * (y1 * n.z) + c.w * a1 * (y1 * n.x);
}

}  // namespace kiln::reference
