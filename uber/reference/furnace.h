#pragma once
// How much of uniform light an isotropic BRDF sends one way, by quadrature in double: its directional albedo, which is also
// the radiance seen in a white furnace. brdf(n, v, l) gives the BRDF times n.l, a number, for n = (0, 0, 1).
//
// Two parametrisations of the same integral. Diffuse lobes are smooth over l. A specular lobe is narrow over l but smooth
// over its half vector with tan(theta_h) = alpha tan(w), as in split_sum_quadrature.h; dl = 4 (v.h) dh.

#include <cmath>

#include "uber/reference/quadrature.h"

namespace kiln::reference {

// A unit vector at `cosine` from the z axis and azimuth phi.
inline Vec3<double> from_polar(double cosine, double phi) {
    const double s = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    return {s * std::cos(phi), s * std::sin(phi), cosine};
}

// For smooth lobes. n_dot_v: (0, 1].
template <class F>
double diffuse_albedo(double n_dot_v, const TanhSinh& quadrature, F brdf) {
    const Vec3<double> n{0, 0, 1}, v = from_polar(n_dot_v, 0);
    return 2.0 * quadrature(0.0, 1.0, [&](double c) {
               return quadrature(0.0, pi, [&](double phi) { return brdf(n, v, from_polar(c, phi)); });
           });
}

// For microfacet lobes. alpha: the width of the half vectors' distribution, positive; only how fast the result converges
// depends on it.
template <class F>
double specular_albedo(double n_dot_v, double alpha, const TanhSinh& quadrature, F brdf) {
    const Vec3<double> n{0, 0, 1}, v = from_polar(n_dot_v, 0);
    const double theta_v = std::acos(n_dot_v), sin_v = std::sin(theta_v);
    const auto ring = [&](double w, bool cut) {
        const double tan_w = std::tan(w), t = alpha * tan_w;
        const double cos_h = 1.0 / std::sqrt(1.0 + t * t), sin_h = t * cos_h;
        double bound = pi;
        if (cut) {
            const double c = (0.5 * n_dot_v / cos_h - n_dot_v * cos_h) / (sin_v * sin_h);
            bound = std::acos(std::fmin(std::fmax(c, -1.0), 1.0));
        }
        const double sum = quadrature(0.0, bound, [&](double phi) {
            const Vec3<double> h{sin_h * std::cos(phi), sin_h * std::sin(phi), cos_h};
            const double v_dot_h = dot(v, h);
            const Vec3<double> l = h * (2.0 * v_dot_h) - v;
            return l.z <= 0.0 ? 0.0 : 4.0 * v_dot_h * brdf(n, v, l);
        });
        return 2.0 * sum * sin_h * alpha * (1.0 + tan_w * tan_w) / (1.0 + t * t);
    };
    const auto w_of = [&](double theta_h) { return std::atan(std::tan(theta_h) / alpha); };
    const double inner = w_of(0.5 * (0.5 * pi - theta_v)), outer = w_of(0.5 * (0.5 * pi + theta_v));
    double sum = quadrature(0.0, inner, [&](double w) { return ring(w, false); });
    if (sin_v > 0.0) sum += quadrature(inner, outer, [&](double w) { return ring(w, true); });
    return sum;
}

// The integral of D n.h over all half vectors, which is 1 for a normalised distribution. d(n, h): isotropic.
template <class F>
double distribution_integral(double alpha, const TanhSinh& quadrature, F d) {
    const Vec3<double> n{0, 0, 1};
    return 2.0 * pi * quadrature(0.0, 0.5 * pi, [&](double w) {
               const double tan_w = std::tan(w), t = alpha * tan_w;
               const double cos_h = 1.0 / std::sqrt(1.0 + t * t), sin_h = t * cos_h;
               return d(n, Vec3<double>{sin_h, 0, cos_h}) * cos_h * sin_h * alpha * (1.0 + tan_w * tan_w) / (1.0 + t * t);
           });
}

}  // namespace kiln::reference
