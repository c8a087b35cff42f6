#pragma once
// Ground truth for indirect light, in double: closed forms of form factors, and paths through scenes of rectangles with the
// standard error of their mean.

#include <array>
#include <vector>

#include "uber/reference/gi_path.h"
#include "uber/reference/random.h"

namespace kiln::reference {

// The form factor of two facing rectangles a x b at distance c (Howell, configuration C-11).
inline double form_factor_parallel(double a, double b, double c) {
    const double x = a / c, y = b / c, x1 = std::sqrt(1 + x * x), y1 = std::sqrt(1 + y * y);
    return 2 / (pi * x * y) *
           (std::log(x1 * y1 / std::sqrt(1 + x * x + y * y)) + x * y1 * std::atan(x / y1) + y * x1 * std::atan(y / x1) -
            x * std::atan(x) - y * std::atan(y));
}

// From a rectangle w x l to one h x l that stands upright on their common edge l (Howell, configuration C-14).
inline double form_factor_perpendicular(double w, double h, double l) {
    const double W = w / l, H = h / l, W2 = W * W, H2 = H * H, both = W2 + H2;
    const double logs = std::log((1 + W2) * (1 + H2) / (1 + both)) + W2 * std::log(W2 * (1 + both) / ((1 + W2) * both)) +
                        H2 * std::log(H2 * (1 + both) / ((1 + H2) * both));
    return (W * std::atan(1 / W) + H * std::atan(1 / H) - std::sqrt(both) * std::atan(1 / std::sqrt(both)) + logs / 4) / (pi * W);
}

// Irradiance at x, n from a rectangle of radiance 1 that lies wholly above x's horizon, nothing in between: Lambert's
// formula, half the sum of edges' angles times the cosine between n and the edge's plane.
inline double polygon_irradiance(const Vec3<double>& x, const Vec3<double>& n, const GiQuad<double>& quad) {
    const std::array<Vec3<double>, 4> corners{quad.origin, quad.origin + quad.u, quad.origin + quad.u + quad.v,
                                              quad.origin + quad.v};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3<double> a = normalize(corners[i] - x), b = normalize(corners[(i + 1) % 4] - x), c = cross(a, b);
        sum += std::atan2(length(c), dot(a, b)) * dot(normalize(c), n);
    }
    return std::fabs(sum) / 2;
}

// Irradiance at x, n in the three channels: light after at most `bounces` reflections, without the lamp's own.
inline std::array<Estimate, 3> gi_irradiance(const std::vector<GiQuad<double>>& quads, const GiLamp<double>& lamp,
                                             const Vec3<double>& x, const Vec3<double>& n, int bounces, int paths,
                                             uint64_t seed) {
    Random random(seed);
    std::array<Samples, 3> samples;
    // Independent paths, not stratified ones: the standard error means what it says.
    for (int i = 0; i < paths; ++i) {
        const Vec3<double> direction = random_cosine(random, n);
        const Vec3<double> l = gi_path(quads, lamp, x, direction, bounces, [&] { return random(); });
        samples[0].add(pi * l.x), samples[1].add(pi * l.y), samples[2].add(pi * l.z);
    }
    return {samples[0].estimate(), samples[1].estimate(), samples[2].estimate()};
}

// The same by first directions of a Fibonacci lattice, moved at random `shifts` times: the directions of one lattice lie evenly,
// so that the error falls with nearly the first power of their number, and the shifts are independent and tell what it is.
inline std::array<Estimate, 3> gi_irradiance_lattice(const std::vector<GiQuad<double>>& quads, const GiLamp<double>& lamp,
                                                     const Vec3<double>& x, const Vec3<double>& n, int bounces, int shifts,
                                                     uint64_t seed) {
    constexpr int count = 4181, generator = 2584;  // F(19), F(18)
    Random random(seed);
    std::array<Samples, 3> samples;
    for (int s = 0; s < shifts; ++s) {
        const double a = random(), b = random();
        Vec3<double> sum{};
        for (int i = 0; i < count; ++i) {
            const double u = (i + 0.5) / count + a, v = static_cast<double>(i) * generator / count + b;
            const Vec3<double> direction = gi_cosine_direction<double>({u - std::floor(u), v - std::floor(v)}, n);
            sum = sum + gi_path(quads, lamp, x, direction, bounces, [&] { return random(); });
        }
        samples[0].add(pi * sum.x / count), samples[1].add(pi * sum.y / count), samples[2].add(pi * sum.z / count);
    }
    return {samples[0].estimate(), samples[1].estimate(), samples[2].estimate()};
}

}  // namespace kiln::reference
