// Follows the papers step by step. Every filter here is a sum of products of one-dimensional Gaussians and their derivatives, so
// that a picture is filtered along x and then along y.
#include "compiler/report/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace kiln::report {

namespace {

constexpr double pi = 3.14159265358979323846;
using Colour = std::array<double, 3>;

// Linear sRGB to XYZ, and the white that (1, 1, 1) gives.
constexpr double to_xyz[3][3] = {{10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
                                 {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
                                 {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}};

Colour xyz_of(const Colour& c) {
    Colour out{};
    for (size_t i = 0; i < 3; ++i) out[i] = to_xyz[i][0] * c[0] + to_xyz[i][1] * c[1] + to_xyz[i][2] * c[2];
    return out;
}
const Colour& white() {
    static const Colour w = xyz_of({1.0, 1.0, 1.0});
    return w;
}
Colour rgb_of_xyz(const Colour& c) {
    // Cramer's rule; the matrix is constant and well conditioned.
    const auto det = [](const Colour& a, const Colour& b, const Colour& d) {
        return a[0] * (b[1] * d[2] - b[2] * d[1]) - b[0] * (a[1] * d[2] - a[2] * d[1]) + d[0] * (a[1] * b[2] - a[2] * b[1]);
    };
    const Colour r{to_xyz[0][0], to_xyz[1][0], to_xyz[2][0]}, g{to_xyz[0][1], to_xyz[1][1], to_xyz[2][1]},
        b{to_xyz[0][2], to_xyz[1][2], to_xyz[2][2]};
    const double whole = det(r, g, b);
    return {det(c, g, b) / whole, det(r, c, b) / whole, det(r, g, c) / whole};
}

// CIELAB's opponent axes without its cube root, and back.
Colour ycxcz_of(const Colour& rgb) {
    const Colour xyz = xyz_of(rgb);
    const double x = xyz[0] / white()[0], y = xyz[1] / white()[1], z = xyz[2] / white()[2];
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}
Colour rgb_of_ycxcz(const Colour& c) {
    const double y = (c[0] + 16.0) / 116.0, x = y + c[1] / 500.0, z = y - c[2] / 200.0;
    return rgb_of_xyz({x * white()[0], y * white()[1], z * white()[2]});
}

// CIELAB with a and b scaled by lightness (the Hunt effect: dark colours look less colourful).
Colour hunt_lab_of(const Colour& rgb) {
    constexpr double delta = 6.0 / 29.0;
    const auto f = [](double t) { return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0; };
    const Colour xyz = xyz_of(rgb);
    const double x = f(xyz[0] / white()[0]), y = f(xyz[1] / white()[1]), z = f(xyz[2] / white()[2]);
    const double l = 116.0 * y - 16.0;
    return {l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)};
}
double hyab(const Colour& a, const Colour& b) { return std::fabs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

using Plane = std::vector<double>;

// taps[radius + i] times the neighbour i, along x or y; the edge pixel goes on for ever. Whole rows at a time, so that a
// compiler makes vectors of them.
Plane filter(const Plane& in, uint32_t width, uint32_t height, const std::vector<double>& taps, bool along_x) {
    const size_t w = width, h = height, radius = taps.size() / 2;
    Plane out(in.size(), 0.0), padded(along_x ? w + 2 * radius : 0);
    for (size_t y = 0; y < h; ++y) {
        double* const row = out.data() + y * w;
        if (along_x) {
            const double* const from = in.data() + y * w;
            for (size_t x = 0; x < padded.size(); ++x) padded[x] = from[x < radius ? 0 : std::min(x - radius, w - 1)];
        }
        for (size_t i = 0; i < taps.size(); ++i) {
            const double tap = taps[i];
            const double* const from =
                along_x ? padded.data() + i : in.data() + (y + i < radius ? 0 : std::min(y + i - radius, h - 1)) * w;
            for (size_t x = 0; x < w; ++x) row[x] += tap * from[x];
        }
    }
    return out;
}

// One term a sqrt(pi / b) exp(-pi^2 d^2 / b) of a contrast sensitivity function's kernel; in two dimensions it is a product.
struct Term {
    double a, b;
};
constexpr std::array<std::array<Term, 2>, 3> sensitivity{
    {{{{1.0, 0.0047}, {0.0, 1e-5}}}, {{{1.0, 0.0053}, {0.0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};

Plane blurred(const Plane& in, uint32_t width, uint32_t height, const std::array<Term, 2>& terms, double pixels_per_degree) {
    constexpr double widest = 0.04;
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(widest / (2.0 * pi * pi)) * pixels_per_degree));
    Plane out(in.size(), 0.0);
    double total = 0.0;
    for (const Term& t : terms) {
        if (t.a == 0.0) continue;
        std::vector<double> taps;
        double sum = 0.0;
        for (int i = -radius; i <= radius; ++i) {
            const double d = i / pixels_per_degree;
            taps.push_back(std::exp(-pi * pi * d * d / t.b));
            sum += taps.back();
        }
        const double weight = t.a * std::sqrt(pi / t.b);
        total += weight * sum * sum;
        const Plane once = filter(filter(in, width, height, taps, true), width, height, taps, false);
        for (size_t i = 0; i < in.size(); ++i) out[i] += weight * once[i];
    }
    for (double& v : out) v /= total;
    return out;
}

// Size of the gradient (edges) or of the second derivatives along x and y (points) of a Gaussian as wide as the eye's detectors.
// Positive taps sum to 1 and negative ones to -1.
Plane features(const Plane& in, uint32_t width, uint32_t height, double pixels_per_degree, bool points) {
    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    std::vector<double> smooth, derived;
    double sum = 0.0, positive = 0.0, negative = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        const double g = std::exp(-i * i / (2.0 * sigma * sigma));
        smooth.push_back(g);
        sum += g;
        derived.push_back(points ? (i * i / (sigma * sigma) - 1.0) * g : -i * g);
        (derived.back() > 0.0 ? positive : negative) += std::fabs(derived.back());
    }
    for (double& t : smooth) t /= sum;
    for (double& t : derived) t /= t > 0.0 ? positive : negative;
    const Plane dx = filter(filter(in, width, height, derived, true), width, height, smooth, false);
    const Plane dy = filter(filter(in, width, height, smooth, true), width, height, derived, false);
    Plane out(in.size());
    for (size_t i = 0; i < in.size(); ++i) out[i] = std::hypot(dx[i], dy[i]);
    return out;
}

}  // namespace

struct FlipReference::Seen {
    std::vector<Colour> colour;  // Hunt-adjusted CIELAB after the eye's blur
    Plane edges, points;
};

namespace {

using Seen = FlipReference::Seen;

Seen look_at(const Picture& picture, double pixels_per_degree) {
    std::array<Plane, 3> planes;
    for (Plane& p : planes) p.resize(picture.pixels());
    Plane luminance(picture.pixels());
    for (size_t i = 0; i < picture.pixels(); ++i) {
        Colour c{picture.rgb[3 * i], picture.rgb[3 * i + 1], picture.rgb[3 * i + 2]};
        for (double& v : c) v = std::clamp(v, 0.0, 1.0);
        const Colour o = ycxcz_of(c);
        for (size_t k = 0; k < 3; ++k) planes[k][i] = o[k];
        luminance[i] = (o[0] + 16.0) / 116.0;
    }
    Seen out;
    out.edges = features(luminance, picture.width, picture.height, pixels_per_degree, false);
    out.points = features(luminance, picture.width, picture.height, pixels_per_degree, true);
    for (size_t k = 0; k < 3; ++k)
        planes[k] = blurred(planes[k], picture.width, picture.height, sensitivity[k], pixels_per_degree);
    for (size_t i = 0; i < picture.pixels(); ++i) {
        Colour c = rgb_of_ycxcz({planes[0][i], planes[1][i], planes[2][i]});
        for (double& v : c) v = std::clamp(v, 0.0, 1.0);
        out.colour.push_back(hunt_lab_of(c));
    }
    return out;
}

double aces(double x) {  // Narkowicz's fit, with the exposure 0.6 inside
    const double y = 0.6 * std::max(x, 0.0);
    return std::clamp(y * (2.51 * y + 0.03) / (y * (2.43 * y + 0.59) + 0.14), 0.0, 1.0);
}

double luminance_of(const Picture& p, size_t i) { return xyz_of({p.rgb[3 * i], p.rgb[3 * i + 1], p.rgb[3 * i + 2]})[1]; }

std::vector<double> difference(const Seen& r, const Seen& t) {
    constexpr double qc = 0.7, pc = 0.4, pt = 0.95, qf = 0.5;
    static const double largest = std::pow(hyab(hunt_lab_of({0.0, 1.0, 0.0}), hunt_lab_of({0.0, 0.0, 1.0})), qc);
    std::vector<double> out(r.colour.size());
    for (size_t i = 0; i < out.size(); ++i) {
        // Most of the range for differences up to 40 % of the largest, the rest squeezed above it.
        const double power = std::pow(hyab(r.colour[i], t.colour[i]), qc);
        const double colour =
            std::min(1.0, power < pc * largest ? power * pt / (pc * largest)
                                               : pt + (power - pc * largest) / (largest - pc * largest) * (1.0 - pt));
        const double feature = std::pow(
            std::min(1.0, std::max(std::fabs(r.edges[i] - t.edges[i]), std::fabs(r.points[i] - t.points[i])) / std::sqrt(2.0)),
            qf);
        out[i] = std::pow(colour, 1.0 - feature);
        if (colour == 0.0 && feature < 1.0) out[i] = 0.0;
    }
    return out;
}

Picture exposed(const Picture& p, const Exposures& e, uint32_t k) {
    const double factor = std::exp2(e.start + (e.stop - e.start) * k / (e.count - 1));
    Picture out(p.width, p.height);
    for (size_t i = 0; i < out.rgb.size(); ++i) out.rgb[i] = std::isfinite(p.rgb[i]) ? aces(p.rgb[i] * factor) : 0.0;
    return out;
}

}  // namespace

std::vector<double> ldr_flip(const Picture& reference, const Picture& test, double pixels_per_degree) {
    assert(reference.rgb.size() == test.rgb.size());
    return difference(look_at(reference, pixels_per_degree), look_at(test, pixels_per_degree));
}

Exposures flip_exposures(const Picture& reference) {
    std::vector<double> luminance(reference.pixels());
    for (size_t i = 0; i < luminance.size(); ++i) luminance[i] = std::max(luminance_of(reference, i), 0.0);
    std::sort(luminance.begin(), luminance.end());
    // Where the tone curve reaches 0.85: (2.51 - 0.85 2.43) y^2 + (0.03 - 0.85 0.59) y - 0.85 0.14 = 0, x = y / 0.6.
    const double a = 2.51 - 0.85 * 2.43, b = 0.03 - 0.85 * 0.59, c = -0.85 * 0.14;
    const double x = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a) / 0.6;
    constexpr double smallest = 1e-10;
    Exposures out;
    if (luminance.empty()) return out;
    out.start = std::log2(x / std::max(luminance.back(), smallest));
    out.stop = std::max(out.start, std::log2(x / std::max(luminance[luminance.size() / 2], smallest)));
    out.count = static_cast<uint32_t>(std::max(2.0, std::ceil(out.stop - out.start)));
    return out;
}

FlipReference::FlipReference(const Picture& reference, const Jobs& jobs, double pixels_per_degree)
    : exposures_(flip_exposures(reference)), pixels_per_degree_(pixels_per_degree), seen_(exposures_.count) {
    jobs.each(seen_.size(),
              [&](size_t k) { seen_[k] = look_at(exposed(reference, exposures_, static_cast<uint32_t>(k)), pixels_per_degree); });
}
FlipReference::~FlipReference() = default;

std::vector<double> FlipReference::against(const Picture& test, const Jobs& jobs) const {
    std::vector<std::vector<double>> each(seen_.size());
    jobs.each(seen_.size(), [&](size_t k) {
        each[k] = difference(seen_[k], look_at(exposed(test, exposures_, static_cast<uint32_t>(k)), pixels_per_degree_));
    });
    std::vector<double> out(test.pixels(), 0.0);
    for (const std::vector<double>& one : each)
        for (size_t i = 0; i < one.size(); ++i) out[i] = std::max(out[i], one[i]);
    for (size_t i = 0; i < test.rgb.size(); ++i)
        if (!std::isfinite(test.rgb[i])) out[i / 3] = 1.0;
    return out;
}

std::vector<double> hdr_flip(const Picture& reference, const Picture& test, double pixels_per_degree) {
    return FlipReference(reference, Jobs(1), pixels_per_degree).against(test, Jobs(1));
}

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values) sum += v;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace kiln::report
