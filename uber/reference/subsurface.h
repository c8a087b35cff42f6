#pragma once
// Subsurface profiles, as uber/lib/subsurface.glsl names them; ..._textbook are the papers' own forms.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
T wrap_diffuse(const T& n_dot_l, const T& wrap) {
    return max((n_dot_l + wrap) / (T(1) + wrap), T(0)) / (T(1) + wrap);
}

template <class T>
Vec3<T> burley_shape_searchlight(const Vec3<T>& albedo) {
    return map(albedo, [](const T& a) { return T(1.85) - a + T(7) * pow(abs(a - T(0.8)), T(3)); });
}
template <class T>
Vec3<T> burley_shape_diffuse(const Vec3<T>& albedo) {
    return map(albedo, [](const T& a) { return T(1.9) - a + T(3.5) * (a - T(0.8)) * (a - T(0.8)); });
}
template <class T>
Vec3<T> burley_shape_mean_free_path(const Vec3<T>& albedo) {
    return map(albedo, [](const T& a) { return T(3.5) + T(100) * pow(abs(a - T(0.33)), T(4)); });
}

template <class T>
Vec3<T> single_scattering_albedo(const Vec3<T>& albedo) {
    return map(albedo, [](const T& a) { return T(1) - exp(T(-5.09406) * a + T(2.61188) * a * a - T(4.31805) * a * a * a); });
}

template <class T>
Vec3<T> burley_profile_r(const T& r, const Vec3<T>& s) {
    return map(s, [&](const T& shape) { return shape * (exp(-shape * r) + exp(-shape * r / T(3))) / T(8 * pi); });
}
template <class T>
Vec3<T> burley_profile(const T& r, const Vec3<T>& s) {
    return map(s, [&](const T& shape) {
        return shape * (exp(-shape * r) + exp(-shape * r / T(3))) / (T(8 * pi) * max(r, T(1e-4) / shape));
    });
}

template <class T>
T burley_cumulative_textbook(const T& r, const T& s) {
    return T(1) - exp(-s * r) / T(4) - T(3) * exp(-s * r / T(3)) / T(4);
}
template <class T>
T burley_cumulative(const T& r, const T& s) {
    const T x = s * r / T(3), g = exp(-x);
    const T one_minus_g = x < T(0.01) ? x * (T(1) - x * (T(0.5) - x / T(6))) : T(1) - g;
    return one_minus_g * (T(4) + g + g * g) / T(4);
}

// By Newton's method on the logarithm of what lies beyond r, which is nearly straight; the share is cut as in the GLSL.
inline double burley_radius_textbook(double u, double s) {
    const double target = std::log(std::fmax(1 - u, 1e-7));
    double x = 0;  // s r
    for (int i = 0; i < 60; ++i) {
        const double a = std::exp(-x) / 4, b = 3 * std::exp(-x / 3) / 4;
        const double step = (std::log(a + b) - target) * (a + b) / (a + b / 3);
        x += step;
        if (std::fabs(step) <= 1e-15 * x) break;
    }
    return std::fmax(x, 0.0) / s;
}
template <class T>
T burley_radius(const T& u, const T& s) {
    if (u < T(0.1)) {
        T y = T(2.0 / 3) * u;
        for (int i = 0; i < 2; ++i) y = y - (y * (T(6) + y * (y - T(3))) - T(4) * u) / (T(6) + y * (T(3) * y - T(6)));
        T series = y / T(6);
        for (const double k : {5.0, 4.0, 3.0, 2.0, 1.0}) series = y * (T(1 / k) + series);
        return T(3) * series / s;
    }
    const T q = max(T(1) - u, T(1e-7));
    const T w = exp2(log2(T(2) * q + sqrt(T(4) * q * q + T(1))) / T(3)), w2 = w * w;
    return T(-3) * log(T(4) * q / (w2 + T(1) + T(1) / w2)) / s;
}

template <class T>
Vec3<T> burley_tap(int i, int n, const T& s, const T& rotation) {
    const T r = burley_radius((T(i) + T(0.5)) / T(n), s);
    const Vec2<T> p = cos_sin_of_turn(fract(T((3 - std::sqrt(5.0)) / 2) * T(i) + rotation / T(2 * pi))) * -r;
    return {p.x, p.y, r};
}

template <class T>
Vec3<T> burley_tap_weight(const T& r, const Vec3<T>& s, const T& s_drawn) {
    const T drawn = max(s_drawn * (exp(-s_drawn * r) + exp(-s_drawn * r / T(3))), T(1e-30));
    return map(s, [&](const T& shape) { return shape * (exp(-shape * r) + exp(-shape * r / T(3))) / drawn; });
}

template <class T>
T burley_transmittance(const T& thickness, const T& s) {
    return (exp(-s * thickness) + T(3) * exp(-s * thickness / T(3))) / T(4);
}
template <class T>
Vec3<T> burley_through_tap(int i, int n, const T& s, const T& thickness, const T& rotation) {
    const T rest = T(1) - (T(i) + T(0.5)) / T(n);
    const T rho = max(burley_radius(T(1) - burley_transmittance(thickness, s) * rest, s), thickness);
    const T r = sqrt((rho - thickness) * (rho + thickness));
    const Vec2<T> p = cos_sin_of_turn(fract(T((3 - std::sqrt(5.0)) / 2) * T(i) + rotation / T(2 * pi))) * -r;
    return {p.x, p.y, rho};
}

// irradiance: (uv) -> Vec3.
template <class T, class F>
Vec3<T> burley_gather(F irradiance, const Vec2<T>& uv, const Vec2<T>& uv_per_length, const Vec3<T>& s, const T& s_drawn,
                      const T& rotation, int taps = 32) {
    Vec3<T> sum = splat3(T(0)), weights = splat3(T(0));
    for (int i = 0; i < taps; ++i) {
        const Vec3<T> tap = burley_tap(i, taps, s_drawn, rotation);
        const Vec3<T> weight = burley_tap_weight(tap.z, s, s_drawn);
        sum = sum + weight * irradiance(uv + tap.xy() * uv_per_length);
        weights = weights + weight;
    }
    return sum / weights;
}

template <class T>
T dipole_boundary(const T& eta) {
    const T f = T(-1.440) / (eta * eta) + T(0.710) / eta + T(0.668) + T(0.0636) * eta;
    return (T(1) + f) / (T(1) - f);
}

template <class T>
Vec3<T> dipole_albedo(const Vec3<T>& albedo, const T& boundary) {
    return map(albedo, [&](const T& a) {
        const T q = sqrt(T(3) * max(T(1) - a, T(0)));
        return a / T(2) * (T(1) + exp(T(-4) / T(3) * boundary * q)) * exp(-q);
    });
}

template <class T>
T dipole_profile(const T& r, const T& sigma_s, const T& sigma_a, const T& boundary) {
    const T sigma_t = sigma_s + sigma_a;
    const T tr = sqrt(T(3) * sigma_a * sigma_t);
    const T zr = T(1) / sigma_t;
    const T zv = zr + T(4) / (T(3) * sigma_t) * boundary;
    const auto source = [&](const T& z) {
        const T d = sqrt(r * r + z * z);
        return z * (tr * d + T(1)) * exp(-tr * d) / (d * d * d);
    };
    return sigma_s / sigma_t * (source(zr) + source(zv)) / T(4 * pi);
}
template <class T>
Vec3<T> dipole_profile(const T& r, const Vec3<T>& sigma_s, const Vec3<T>& sigma_a, const T& boundary) {
    return {dipole_profile(r, sigma_s.x, sigma_a.x, boundary), dipole_profile(r, sigma_s.y, sigma_a.y, boundary),
            dipole_profile(r, sigma_s.z, sigma_a.z, boundary)};
}

// As sinh and cosh have it, in double.
inline double multipole_transmittance_textbook(double thickness, double sigma_s, double sigma_a, double boundary) {
    const double sigma_t = sigma_s + sigma_a, tr = std::fmax(std::sqrt(3 * sigma_a * sigma_t), 1e-3 * sigma_t);
    const double beyond = 2 * boundary / (3 * sigma_t), depth = std::fmin(2 / (3 * sigma_t), thickness);
    return sigma_s / sigma_t * std::sinh(tr * (depth + beyond)) * std::cosh(tr * beyond) /
           std::sinh(tr * (thickness + 2 * beyond));
}
template <class T>
T multipole_transmittance(const T& thickness, const T& sigma_s, const T& sigma_a, const T& boundary) {
    const T sigma_t = sigma_s + sigma_a;
    const T tr = max(sqrt(T(3) * sigma_a * sigma_t), T(1e-3) * sigma_t);
    const T beyond = T(2.0 / 3) * boundary / sigma_t, depth = min(T(2.0 / 3) / sigma_t, thickness);
    const T into = T(1) - exp(T(-2) * tr * (depth + beyond)), out_of = T(1) + exp(T(-2) * tr * beyond);
    const T across = T(1) - exp(T(-2) * tr * (thickness + T(2) * beyond));
    return T(0.5) * sigma_s / sigma_t * exp(-tr * (thickness - depth)) * into * out_of / across;
}

}  // namespace kiln::reference
