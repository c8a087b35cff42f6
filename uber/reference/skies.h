#pragma once
// Ground truth: skies whose irradiance and whose spherical harmonics are known in closed form. Double only.

#include "uber/reference/sh.h"

namespace kiln::reference {

// Irradiance from a cap of radiance 1 and half-angle s in [0, pi/2], on a receiver whose normal makes an angle with
// cosine c with the cap's axis. Above the horizon pi sin^2 s c; the part that straddles it as Lagarde and de Rousiers 2014
// give it for a sphere light (a cap seen from its centre), section 4.7.
inline double cap_irradiance(double c, double s) {
    const double angle = std::acos(std::clamp(c, -1.0, 1.0));
    const double sin_s = std::sin(s);
    if (s <= 0.0 || angle >= pi / 2 + s) return 0.0;
    if (angle + s <= pi / 2) return pi * sin_s * sin_s * c;
    const double x = std::cos(s) / sin_s;  // sqrt(1 / sin^2 s - 1)
    const double sin_angle = std::sin(angle);
    const double y = std::clamp(-x * std::cos(angle) / sin_angle, -1.0, 1.0);
    const double root = std::sqrt(1.0 - y * y);
    return sin_s * sin_s * (std::cos(angle) * std::acos(y) - x * sin_angle * root) + std::atan2(sin_angle * root, x);
}

// Orthonormal coefficients of a cap of radiance 1, half-angle s, about the unit vector axis.
inline ShL2<double> cap_sh(const Vec3<double>& axis, double s) {
    const double c = std::cos(s);
    // 2 pi times the integral of P_l over [c, 1]; a zonal function's coefficient is that times Y_lm(axis).
    const double band[3] = {2.0 * pi * (1.0 - c), pi * (1.0 - c * c), pi * c * (1.0 - c * c)};
    const std::array<double, 9> y = sh_l2_basis(axis);
    ShL2<double> out;
    for (size_t i = 0; i < 9; ++i) out.c[i] = splat3(band[sh_band[i]] * y[i]);
    return out;
}

// A sky of radiance a + b (axis . p), |b| <= a, fills L1 exactly. Its irradiance on normal n with axis . n = c.
inline double linear_sky_irradiance(double a, double b, double c) { return pi * a + 2.0 * pi / 3.0 * b * c; }
inline ShMomentsL1<double> linear_sky_moments(double a, double b, const Vec3<double>& axis) {
    const double m1 = 4.0 * pi / 3.0 * b;
    return {splat3(4.0 * pi * a), splat3(m1 * axis.y), splat3(m1 * axis.z), splat3(m1 * axis.x)};
}

// f summed over the sphere: nodes midway in azimuth, by 16-point Gauss-Legendre in height on each of `pieces` equal
// intervals. Exact for polynomials of degree below 2 x 16 in height and `turns` in azimuth.
template <class F>
auto sphere_integral(int pieces, int turns, F f) {
    static constexpr double node[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                       0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
    static constexpr double weight[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                         0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};
    decltype(f(Vec3<double>{})) sum{};
    for (int piece = 0; piece < pieces; ++piece) {
        for (int i = 0; i < 16; ++i) {
            const double t = i < 8 ? node[i] : -node[i - 8];
            const double z = -1.0 + (2.0 * piece + 1.0 + t) / pieces;
            const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
            for (int j = 0; j < turns; ++j) {
                const double phi = 2.0 * pi * (j + 0.5) / turns;
                sum =
                    sum + f(Vec3<double>{r * std::cos(phi), r * std::sin(phi), z}) * (weight[i % 8] / pieces * 2.0 * pi / turns);
            }
        }
    }
    return sum;
}

}  // namespace kiln::reference
