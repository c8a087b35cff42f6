#pragma once
// Ground truth for a smooth fibre: a ray followed through a dielectric cylinder of radius 1 about the x axis by vectors
// alone, in double. What leaves by R, TT and TRT, and in which direction across the fibre.

#include <array>

#include "uber/reference/numbers.h"

namespace kiln::reference {

struct FibrePath {
    double share = 0;          // of the radiance that arrives
    Vec3<double> direction{};  // away from the fibre
};

// Fresnel's unpolarised reflectance for a ray from index n1 into n2; 1 under total reflection.
inline double fibre_reflectance(double cos_i, double n1, double n2) {
    const double sin_t = n1 / n2 * std::sqrt(1 - cos_i * cos_i);
    if (sin_t >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin_t * sin_t);
    const double s = (n1 * cos_i - n2 * cos_t) / (n1 * cos_i + n2 * cos_t);
    const double p = (n2 * cos_i - n1 * cos_t) / (n2 * cos_i + n1 * cos_t);
    return (s * s + p * p) / 2;
}

// The ray leaves the eye along (sin_theta, -cos_theta, 0), so that to_eye = (-sin_theta, cos_theta, 0), and meets the fibre
// at offset h along z; eta: index within; absorption: per radius.
inline std::array<FibrePath, 3> trace_fibre(double sin_theta, double h, double eta, double absorption) {
    const auto refract = [](const Vec3<double>& d, const Vec3<double>& n, double ratio) {  // n against d
        const double c = -dot(d, n);
        const double k = std::sqrt(1 - ratio * ratio * (1 - c * c));
        return d * ratio + n * (ratio * c - k);
    };
    const double cos_theta = std::sqrt(1 - sin_theta * sin_theta);
    const Vec3<double> in{sin_theta, -cos_theta, 0};
    Vec3<double> at{0, std::sqrt(1 - h * h), h};
    Vec3<double> n = at;
    const double f = fibre_reflectance(-dot(in, n), 1, eta);
    std::array<FibrePath, 3> paths;
    paths[0] = {f, reflect(in, n)};
    Vec3<double> d = refract(in, n, 1 / eta);
    double share = 1 - f;
    for (std::size_t p = 1; p < 3; ++p) {
        // Across the circle: |at + t d| = 1 in y and z.
        const double t = -2 * (at.y * d.y + at.z * d.z) / (d.y * d.y + d.z * d.z);
        at = at + d * t;
        n = {0, -at.y, -at.z};
        share *= std::exp(-absorption * t);
        const double inner = fibre_reflectance(-dot(d, n), eta, 1);
        paths[p] = {share * (1 - inner), refract(d, n, eta)};
        share *= inner;
        d = reflect(d, n);
    }
    return paths;
}

}  // namespace kiln::reference
