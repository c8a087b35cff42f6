#pragma once
// Parameters as they come from files and tools, put right once when they are loaded, so that no shader has to look at them
// again: what is not a number becomes the parameter's default, what lies out of its range the nearest end. Each input that
// was changed gets one warning that names it. What cannot be put right is refused with an error.
//
// Ranges are those of uber/surface_interface.glsl and of the functions' comments.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "uber/reference/numbers.h"

namespace kiln::reference {

using Warnings = std::vector<std::string>;

// A number above this times the largest attenuation (1e4) and the sharpest highlight (D V, 2e8) would leave single precision.
inline constexpr double largest_intensity = 1e26;
inline constexpr double largest_half = 65504;

struct Limits {
    double low, high, otherwise;  // otherwise: in place of NaN
};

namespace detail {

inline std::string shown(double x) {
    if (std::isnan(x)) return "not a number";
    if (std::isinf(x)) return x > 0 ? "infinite" : "minus infinity";
    std::string text = std::to_string(x);
    return std::fabs(x) >= 1e15 ? "above " + std::string(x < 0 ? "(in size) " : "") + "1e15" : text;
}

}  // namespace detail

inline double sanitise(const std::string& name, double x, const Limits& limits, Warnings& warnings) {
    const double y = std::isnan(x) ? limits.otherwise : std::min(std::max(x, limits.low), limits.high);
    if (!(x == y)) warnings.push_back(name + " is " + detail::shown(x) + ": " + std::to_string(y) + " is used");
    return y;
}

// One warning for the whole vector.
inline Vec3<double> sanitise(const std::string& name, const Vec3<double>& v, const Limits& limits, Warnings& warnings) {
    Warnings each;
    const Vec3<double> out{sanitise(name, v.x, limits, each), sanitise(name, v.y, limits, each),
                           sanitise(name, v.z, limits, each)};
    if (!each.empty()) warnings.push_back(each.front() + (each.size() > 1 ? "; further components likewise" : ""));
    return out;
}

// Block Material of surface.
struct MaterialParameters {
    Vec3<double> base_factor{1, 1, 1}, specular_factor{1, 1, 1}, emissive{0, 0, 0};
    double dielectric_specular = 0.5, shininess = 32, roughness_factor = 1, metallic_factor = 0, glossiness_factor = 1;
};

// pushed: "parameters should be allowed to be pushed beyond their plausible range" (Burley 2012), as far as the pushed forms
// of material_models.glsl go.
inline MaterialParameters sanitise(const std::string& name, MaterialParameters m, Warnings& warnings, bool pushed = false) {
    const Limits colour{0, pushed ? 1e6 : 1, 1}, share{0, 1, 0};
    m.base_factor = sanitise(name + ": base_factor", m.base_factor, colour, warnings);
    m.specular_factor = sanitise(name + ": specular_factor", m.specular_factor, colour, warnings);
    m.emissive = sanitise(name + ": emissive", m.emissive, {0, largest_intensity, 0}, warnings);
    m.dielectric_specular = sanitise(name + ": dielectric_specular", m.dielectric_specular, {0, 1, 0.5}, warnings);
    m.shininess = sanitise(name + ": shininess", m.shininess, {1, 2048, 32}, warnings);
    m.roughness_factor = sanitise(name + ": roughness_factor", m.roughness_factor, {0, pushed ? 4.0 : 1.0, 1}, warnings);
    m.metallic_factor = sanitise(name + ": metallic_factor", m.metallic_factor, pushed ? Limits{-1, 2, 0} : share, warnings);
    m.glossiness_factor = sanitise(name + ": glossiness_factor", m.glossiness_factor, share, warnings);
    return m;
}

// Block Light of surface.
struct LightParameters {
    Vec3<double> intensity{1, 1, 1}, position{0, 0, 0}, direction{0, -1, 0};
    double range = 10, cos_inner = 0.9, cos_outer = 0.8;
};

inline LightParameters sanitise(const std::string& name, LightParameters l, Warnings& warnings) {
    l.intensity = sanitise(name + ": intensity", l.intensity, {0, largest_intensity, 0}, warnings);
    l.position = sanitise(name + ": position", l.position, {-1e9, 1e9, 0}, warnings);
    l.direction = sanitise(name + ": direction", l.direction, {-1e9, 1e9, 0}, warnings);
    const double size = std::sqrt(l.direction.x * l.direction.x + l.direction.y * l.direction.y + l.direction.z * l.direction.z);
    if (size < 1e-9) {
        l.direction = {0, -1, 0};
        warnings.push_back(name + ": direction has no length: down is used");
    } else {
        l.direction = {l.direction.x / size, l.direction.y / size, l.direction.z / size};
    }
    l.range = sanitise(name + ": range", l.range, {1e-3, 1e9, 10}, warnings);
    l.cos_inner = sanitise(name + ": cos_inner", l.cos_inner, {-1, 1, 1}, warnings);
    l.cos_outer = sanitise(name + ": cos_outer", l.cos_outer, {-1, 1, -1}, warnings);
    return l;
}

// One channel of a probe or a lightmap texel as raw moments (sh.glsl): m0 is the integral of radiance, m1 of radiance times
// direction. Light has m0 >= 0 and |m1| <= m0.
struct ShMoments {
    double m0 = 0;
    Vec3<double> m1{0, 0, 0};
};

inline ShMoments sanitise(const std::string& name, ShMoments m, Warnings& warnings) {
    const bool finite = std::isfinite(m.m0) && std::isfinite(m.m1.x) && std::isfinite(m.m1.y) && std::isfinite(m.m1.z);
    if (!finite || m.m0 < 0) {
        warnings.push_back(name + (finite ? ": negative light (m0 is " + detail::shown(m.m0) + ")" : ": not finite") +
                           ": dark instead");
        return {};
    }
    const double largest = std::max(std::max(std::fabs(m.m1.x), std::fabs(m.m1.y)), std::fabs(m.m1.z));
    if (largest == 0) return m;
    const Vec3<double> s{m.m1.x / largest, m.m1.y / largest, m.m1.z / largest};
    const double size = largest * std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
    if (size > m.m0 * (1 + 1e-6)) {  // what rounding to fp32 leaves is no fault
        const double scale = m.m0 / size;
        m.m1 = {m.m1.x * scale, m.m1.y * scale, m.m1.z * scale};
        warnings.push_back(name + ": more direction than light (|m1| / m0 is " +
                           (m.m0 > 0 ? detail::shown(size / m.m0) : "infinite") + "): scaled to 1");
    }
    return m;
}

// Radiance of an environment or lightmap, row after row.
struct HdrImage {
    size_t width = 0, height = 0, channels = 3;
    std::vector<float> texels;
};

// NaN and negative become 0, infinite and above `limit` the limit, with one warning that counts them and names the first. A
// sun is better taken out of the map beforehand: environment_excess in environment.glsl says what it is worth.
// Returns an error, empty if there is an image.
inline std::string sanitise(const std::string& name, HdrImage& image, Warnings& warnings, double limit = largest_half) {
    if (image.width == 0 || image.height == 0 || image.channels == 0)
        return name + ": a size of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " holds no texel";
    if (image.texels.size() / image.channels / image.width != image.height ||
        image.texels.size() % (image.channels * image.width) != 0)
        return name + ": " + std::to_string(image.texels.size()) + " values do not make " + std::to_string(image.width) + " x " +
               std::to_string(image.height) + " texels of " + std::to_string(image.channels);
    size_t changed = 0, first = 0;
    double was = 0;
    for (size_t i = 0; i < image.texels.size(); ++i) {
        const double x = static_cast<double>(image.texels[i]);
        const double y = std::isnan(x) ? 0 : std::min(std::max(x, 0.0), limit);
        if (x == y) continue;
        if (changed++ == 0) first = i / image.channels, was = x;
        image.texels[i] = static_cast<float>(y);
    }
    if (changed > 0)
        warnings.push_back(name + ": " + std::to_string(changed) + " of " + std::to_string(image.texels.size()) +
                           " values are not in [0, " + std::to_string(static_cast<long long>(limit)) +
                           "] and are limited, the first (" + detail::shown(was) + ") at (" +
                           std::to_string(first % image.width) + ", " + std::to_string(first / image.width) + ")");
    return {};
}

}  // namespace kiln::reference
