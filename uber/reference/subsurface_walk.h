#pragma once
// Ground truth for light under a surface: random walks through a medium of isotropic scatterers of the surface's own index,
// in double, with the standard error. By reciprocity a walk starts where the light is seen, with a cosine about the inward
// normal, and gathers the irradiance where it comes out: the exitance over the irradiance with light that enters diffusely.
// Also Chandrasekhar's closed form for the half space, which the walk is held against.

#include <vector>

#include "uber/reference/random.h"

namespace kiln::reference {

// A medium: albedo of one scattering, mean free path.
struct Medium {
    double albedo = 0.9;
    double mean_free_path = 1;
};

// One walk. inside_for: (position, direction) -> distance to the surface; gather: (exit) -> irradiance there.
// Below a weight of 0.1 Russian roulette with even odds, so that long walks end and nothing is biased.
template <class Distance, class Gather>
double subsurface_walk(Random& random, const Medium& medium, Vec3<double> at, Vec3<double> direction, Distance inside_for,
                       Gather gather) {
    double weight = 1;
    for (;;) {
        const double step = -std::log1p(-random()) * medium.mean_free_path;
        const double rest = inside_for(at, direction);
        if (step >= rest) return weight * gather(at + direction * rest);
        at = at + direction * step;
        direction = random_direction(random);
        weight *= medium.albedo;
        if (weight < 0.1) {
            if (random() < 0.5) return 0;
            weight *= 2;
        }
    }
}

// Seen at (x, 0, 0) of the half space z < 0 under irradiance (position) -> double.
template <class Irradiance>
Estimate subsurface_half_space(const Medium& medium, double x, int walks, uint64_t seed, Irradiance irradiance) {
    Random random(seed);
    Samples samples;
    const auto inside_for = [](const Vec3<double>& p, const Vec3<double>& d) {
        return d.z > 0 ? -p.z / d.z : std::numeric_limits<double>::infinity();
    };
    for (int i = 0; i < walks; ++i) {
        const Vec3<double> direction = random_cosine(random, {0, 0, -1});
        samples.add(subsurface_walk(random, medium, {x, 0, 0}, direction, inside_for, irradiance));
    }
    return samples.estimate();
}

// Seen at the front (0, 0, 0) of a slab between z = -thickness and 0; irradiance gets the exit, on either face.
template <class Irradiance>
Estimate subsurface_slab(const Medium& medium, double thickness, int walks, uint64_t seed, Irradiance irradiance) {
    Random random(seed);
    Samples samples;
    const auto inside_for = [&](const Vec3<double>& p, const Vec3<double>& d) {
        return d.z > 0 ? -p.z / d.z : (d.z < 0 ? (-thickness - p.z) / d.z : std::numeric_limits<double>::infinity());
    };
    for (int i = 0; i < walks; ++i) {
        const Vec3<double> direction = random_cosine(random, {0, 0, -1});
        samples.add(subsurface_walk(random, medium, {0, 0, 0}, direction, inside_for, irradiance));
    }
    return samples.estimate();
}

// Seen on a sphere of this radius about 0 in the direction n from its centre; irradiance gets the exit.
template <class Irradiance>
Estimate subsurface_sphere(const Medium& medium, double radius, const Vec3<double>& n, int walks, uint64_t seed,
                           Irradiance irradiance) {
    Random random(seed);
    Samples samples;
    const auto inside_for = [&](const Vec3<double>& p, const Vec3<double>& d) {
        const double b = dot(p, d), c = dot(p, p) - radius * radius;
        return -b + std::sqrt(std::fmax(b * b - c, 0.0));
    };
    for (int i = 0; i < walks; ++i) {
        const Vec3<double> direction = random_cosine(random, -n);
        samples.add(subsurface_walk(random, medium, n * radius, direction, inside_for, irradiance));
    }
    return samples.estimate();
}

// For a walk that ends as far as `distance` from where it began on a plane, in any direction alike: the share of directions
// whose end lies at x + distance cos > 0.
inline double share_beyond_an_edge(double x, double distance) {
    return x >= distance ? 1.0 : x <= -distance ? 0.0 : 1.0 - std::acos(x / distance) / pi;
}

// The mean over phi of max(0, a + b cos phi), b >= 0.
inline double mean_clamped_cosine(double a, double b) {
    if (a >= b) return a;
    if (a <= -b) return 0.0;
    const double end = std::acos(-a / b);
    return (a * end + b * std::sin(end)) / pi;
}

// Many receivers from the same walks, since all begin alike, and every end stands for its whole circle: at x before or beyond
// the edge of the light on a half space (x > 0 is lit) ...
inline std::vector<Estimate> subsurface_edge(const Medium& medium, const std::vector<double>& x, int walks, uint64_t seed) {
    Random random(seed);
    std::vector<Samples> samples(x.size());
    const auto inside_for = [](const Vec3<double>& p, const Vec3<double>& d) {
        return d.z > 0 ? -p.z / d.z : std::numeric_limits<double>::infinity();
    };
    for (int i = 0; i < walks; ++i) {
        Vec3<double> exit{};
        const Vec3<double> direction = random_cosine(random, {0, 0, -1});
        const double weight = subsurface_walk(random, medium, {0, 0, 0}, direction, inside_for, [&](const Vec3<double>& at) {
            exit = at;
            return 1.0;
        });
        const double distance = std::hypot(exit.x, exit.y);
        for (std::size_t k = 0; k < x.size(); ++k)
            samples[k].add(weight == 0 ? 0 : weight * share_beyond_an_edge(x[k], distance));
    }
    std::vector<Estimate> out;
    for (const Samples& s : samples) out.push_back(s.estimate());
    return out;
}

// ... at x before or beyond an edge of the light on the back of a slab, seen from its front ...
inline std::vector<Estimate> subsurface_slab_edge(const Medium& medium, double thickness, const std::vector<double>& x, int walks,
                                                  uint64_t seed) {
    Random random(seed);
    std::vector<Samples> samples(x.size());
    const auto inside_for = [&](const Vec3<double>& p, const Vec3<double>& d) {
        return d.z > 0 ? -p.z / d.z : (d.z < 0 ? (-thickness - p.z) / d.z : std::numeric_limits<double>::infinity());
    };
    for (int i = 0; i < walks; ++i) {
        Vec3<double> exit{};
        const Vec3<double> direction = random_cosine(random, {0, 0, -1});
        const double weight = subsurface_walk(random, medium, {0, 0, 0}, direction, inside_for, [&](const Vec3<double>& at) {
            exit = at;
            return at.z < -0.5 * thickness ? 1.0 : 0.0;
        });
        const double distance = std::hypot(exit.x, exit.y);
        for (std::size_t k = 0; k < x.size(); ++k)
            samples[k].add(weight == 0 ? 0 : weight * share_beyond_an_edge(x[k], distance));
    }
    std::vector<Estimate> out;
    for (const Samples& s : samples) out.push_back(s.estimate());
    return out;
}

// ... and at these cosines from the pole of a sphere that parallel light shines on.
inline std::vector<Estimate> subsurface_terminator(const Medium& medium, double radius, const std::vector<double>& cosines,
                                                   int walks, uint64_t seed) {
    Random random(seed);
    std::vector<Samples> samples(cosines.size());
    const auto inside_for = [&](const Vec3<double>& p, const Vec3<double>& d) {
        const double b = dot(p, d), c = dot(p, p) - radius * radius;
        return -b + std::sqrt(std::fmax(b * b - c, 0.0));
    };
    for (int i = 0; i < walks; ++i) {
        double cosine = 1;
        const Vec3<double> direction = random_cosine(random, {0, 0, -1});
        const double weight = subsurface_walk(random, medium, {0, 0, radius}, direction, inside_for, [&](const Vec3<double>& at) {
            cosine = std::fmin(std::fmax(at.z / radius, -1.0), 1.0);
            return 1.0;
        });
        const double sine = std::sqrt(1 - cosine * cosine);
        for (std::size_t k = 0; k < cosines.size(); ++k)
            samples[k].add(
                weight == 0 ? 0
                            : weight * mean_clamped_cosine(cosine * cosines[k], sine * std::sqrt(1 - cosines[k] * cosines[k])));
    }
    std::vector<Estimate> out;
    for (const Samples& s : samples) out.push_back(s.estimate());
    return out;
}

// Chandrasekhar's H for isotropic scattering, mu in [0, 1], albedo in [0, 1):
//   ln H = -mu/pi integral over [0, inf) of ln(1 - albedo atan(t)/t) / (1 + mu^2 t^2) dt,   t = tan(a)
// by the midpoint rule in a.
inline double chandrasekhar_h(double albedo, double mu, int points = 2000) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
        const double a = pi / 2 * (i + 0.5) / points, c = std::cos(a), s = std::sin(a);
        sum += std::log(1 - albedo * a * c / s) / (c * c + mu * mu * s * s);
    }
    return std::exp(-mu / pi * sum * pi / 2 / points);
}

// What a half space reflects of diffuse light: 2 integral of (1 - sqrt(1 - albedo) H(mu)) mu dmu.
inline double half_space_albedo(double albedo, int points = 200) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
        const double mu = (i + 0.5) / points;
        sum += (1 - std::sqrt(1 - albedo) * chandrasekhar_h(albedo, mu)) * mu;
    }
    return 2 * sum / points;
}

}  // namespace kiln::reference
