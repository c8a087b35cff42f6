#pragma once
// What a fibre scatters over the directions of light, as uber/study_hair.frag has it: the form by its name in
// manifests/library.yaml.

#include <string>

#include "uber/reference/bounded.h"
#include "uber/reference/depth_map.h"
#include "uber/reference/fading.h"
#include "uber/reference/hair.h"
#include "uber/reference/hair_cheap.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

struct HairBlock {
    Vec3<double> towards_eye, hair_colour, lamp_brightness;
    double beta_m = 0, beta_n = 0, across = 0, tilt = 0, backlit = 0, specular_level = 0, shininess = 0;
};

// As uber/study_directions.glsl.
template <class T>
Vec3<T> square_direction(const Vec2<T>& uv) {
    const Vec2<T> p{(uv.x * T(2) - T(1)) * T(2), (uv.y * T(2) - T(1)) * T(-2)};
    const T p2 = dot(p, p);
    return Vec3<T>{T(2) * p.x, T(2) * p.y, T(1) - p2} / (T(1) + p2);
}

// I0 in ten terms, and what is printed over it; see uber/lib/hair_published.glsl.
template <class T>
T bessel_i0_ten_terms(const T& x) {
    const T y = T(0.25) * x * x;
    T sum(1), term(1);
    for (int k = 1; k < 10; ++k) {
        term = term * (y / T(k * k));
        sum = sum + term;
    }
    return sum;
}
template <class T>
T hair_longitudinal_printed(const T& si, const T& ci, const T& so, const T& co, const T& v) {
    return exp(-si * so / v) * bessel_i0_ten_terms(ci * co / v) / (T(2) * v * sinh(T(1) / v));
}
template <class T>
T hair_longitudinal_log(const T& si, const T& ci, const T& so, const T& co, const T& v) {
    const T x = ci * co / v;
    const T log_i0 = x > T(12) ? x + T(0.5) * (-log(T(2 * pi) * x) + T(1) / (T(8) * x)) : log(bessel_i0_ten_terms(x));
    return exp(log_i0 - si * so / v - T(1) / v + T(0.6931) + log(T(1) / (T(2) * v)));
}

template <class T>
Vec3<T> study_hair(const std::string& form, const HairBlock& b, const Vec2<T>& uv) {
    const auto vector = [](const Vec3<double>& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> l = square_direction(uv), v = safe_normalize(vector(b.towards_eye), Vec3<T>{T(0), T(0), T(1)});
    const Vec3<T> tangent{T(1), T(0), T(0)}, colour = vector(b.hair_colour);
    const T along = clamp(T(b.beta_m), T(0.2), T(1)), around = clamp(T(b.beta_n), T(0.2), T(1)), level(b.specular_level);
    const auto scattered = [&]() -> Vec3<T> {
        if (form == "karis") return hair_karis(tangent, l, v, colour, along, level, T(b.backlit));
        if (form == "kajiya_kay") return hair_kajiya_kay(tangent, l, v, colour / T(pi), splat3(level), T(b.shininess));
        if (form == "scheuermann") {
            const T sine = sqrt(saturate((T(1) - l.x) * (T(1) + l.x)));
            return colour / T(pi) * sine + splat3(level * hair_scheuermann(tangent, l, v, T(b.shininess)));
        }
        if (form.rfind("chiang", 0) == 0) {
            HairFibre<T> fibre;
            fibre.absorption = hair_absorption(colour, around);
            fibre.eta = T(1.55);
            fibre.beta_m = along;
            fibre.beta_n = around;
            fibre.tilt = T(0.1) * T(b.tilt);
            return form == "chiang" ? hair_chiang(fibre, l, v, T(b.across)) : hair_chiang_width(fibre, l, v, 4);
        }
        const T variance = hair_variance(0, along);
        const auto off = [](const Vec3<T>& w) { return length(Vec2<T>{w.y, w.z}); };
        if (form == "longitudinal_printed") return splat3(hair_longitudinal_printed(l.x, off(l), v.x, off(v), variance));
        if (form == "longitudinal_log") return splat3(hair_longitudinal_log(l.x, off(l), v.x, off(v), variance));
        return splat3(hair_longitudinal(l.x, off(l), v.x, off(v), variance));
    };
    return scattered() * vector(b.lamp_brightness);
}

}  // namespace kiln::reference
