#pragma once
// Scattering of a hair fibre after Chiang et al. 2016, as uber/lib/hair.glsl names it and in its forms; hair_textbook.h has
// the papers'.

#include "uber/reference/bessel.h"
#include "uber/reference/fading.h"
#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
struct HairFibre {
    Vec3<T> absorption{};
    T eta = T(1.55);
    T beta_m = T(0.3);
    T beta_n = T(0.3);
    T tilt = T(0);
};

template <class T>
T hair_fresnel(const T& cosine, const T& eta) {
    const T g = sqrt(max(eta * eta - T(1) + cosine * cosine, T(0)));
    const T a = (g - cosine) / (g + cosine);
    const T b = (cosine * (g + cosine) - T(1)) / (cosine * (g - cosine) + T(1));
    return a * a * (T(1) + b * b) / T(2);
}

namespace hair {

// x^16 by squares.
template <class T>
T power_16(const T& x) {
    const T x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
    return x8 * x8;
}

// sqrt(1 - x^2).
template <class T>
T cosine_of(const T& x) {
    return sqrt((T(1) - x) * (T(1) + x));
}

}  // namespace hair

template <class T>
T hair_variance(int p, const T& b) {
    const T root = T(0.726) * b + T(0.812) * b * b + T(3.7) * hair::power_16(b) * b * b * b * b;
    const T v = root * root;
    return max(p == 0 ? v : (p == 1 ? T(0.25) * v : T(4) * v), T(1e-5));
}

template <class T>
T hair_logistic_scale(const T& b) {
    const T b2 = b * b;
    return max(T(std::sqrt(pi / 8)) * (T(0.265) * b + T(1.194) * b2 + T(5.372) * hair::power_16(b) * b2 * b2 * b2), T(1e-3));
}

template <class T>
T hair_longitudinal(const T& si, const T& ci, const T& so, const T& co, const T& v) {
    const T dc = ci - co, ds = si + so;
    return fading(-(dc * dc + ds * ds) / (T(2) * v)) * bessel_i0_scaled(ci * co / v) / (v * (T(1) - exp(T(-2) / v)));
}

template <class T>
T hair_azimuthal(const T& phi, int p, const T& s, const T& gamma_o, const T& gamma_t) {
    const T d = phi - (T(2 * p) * gamma_t - T(2) * gamma_o + T(p * pi));
    const T x = d - T(2 * pi) * floor(d / T(2 * pi) + T(0.5));
    const T e = fading(-abs(x) / s), cut = exp(T(-pi) / s);
    return e * (T(1) + cut) / (s * (T(1) + e) * (T(1) + e) * (T(1) - cut));
}

template <class T>
Vec3<T> hair_attenuation(int p, const T& f, const Vec3<T>& t) {
    return map(t, [&](const T& through) {
        if (p == 0) return f;
        const T enters = T(1) - f;
        if (p == 1) return enters * enters * through;
        if (p == 2) return enters * enters * f * through * through;
        const T quotient = clamp(enters / max(enters + f * (T(1) - through), T(1e-20)), T(0), T(1));
        return enters * through * through * through * f * f * quotient;
    });
}

template <class T>
Vec3<T> hair_transmittance(const Vec3<T>& absorption, const T& cos_gamma_t, const T& cos_theta_t) {
    return map(absorption, [&](const T& a) { return exp(-a * (T(2) * cos_gamma_t / cos_theta_t)); });
}

template <class T>
Vec3<T> hair_absorption(const Vec3<T>& colour, const T& b) {
    const T d = T(5.969) + b * (T(-0.215) + b * (T(2.532) + b * (T(-10.73) + b * (T(5.574) + b * T(0.245)))));
    return map(colour, [&](const T& c) {
        const T x = log(clamp(c, T(1e-3), T(1))) / d;
        return x * x;
    });
}

template <class T>
Vec3<T> hair_chiang(const HairFibre<T>& fibre, const Vec3<T>& to_light, const Vec3<T>& to_eye, const T& h) {
    const auto off = [](const Vec3<T>& w) { return length(Vec2<T>{w.y, w.z}); };
    const T si = clamp(to_light.x, T(-1), T(1)), ci = off(to_light);
    const T so = clamp(to_eye.x, T(-1), T(1)), co = off(to_eye);
    const T across = to_eye.y * to_light.z - to_eye.z * to_light.y;
    const T along = to_eye.y * to_light.y + to_eye.z * to_light.z;
    const T phi = value(across) == 0 && value(along) == 0 ? T(0) : atan(across, along);

    const T sin_gamma_o = clamp(h, T(-1), T(1)), cos_gamma_o = hair::cosine_of(sin_gamma_o);
    const T sin_gamma_t = clamp(sin_gamma_o * co * inversesqrt(fibre.eta * fibre.eta - so * so), T(-1), T(1));
    const T cos_gamma_t = hair::cosine_of(sin_gamma_t), cos_theta_t = hair::cosine_of(so / fibre.eta);
    const T gamma_o = atan(sin_gamma_o, cos_gamma_o), gamma_t = atan(sin_gamma_t, cos_gamma_t);

    const T f = hair_fresnel(co * cos_gamma_o, fibre.eta);
    const Vec3<T> t = hair_transmittance(fibre.absorption, cos_gamma_t, cos_theta_t);
    const T s = hair_logistic_scale(fibre.beta_n);
    const T rest = hair_longitudinal(si, ci, so, co, hair_variance(3, fibre.beta_m)) / T(2 * pi);
    Vec3<T> sum = hair_attenuation(3, f, t) * rest;
    const T turns[] = {T(-2), T(1), T(4)};
    for (int p = 0; p < 3; ++p) {
        const T sine = sin(turns[p] * fibre.tilt), cosine = cos(turns[p] * fibre.tilt);
        const T lobe =
            hair_longitudinal(si, ci, so * cosine + co * sine, abs(co * cosine - so * sine), hair_variance(p, fibre.beta_m)) *
            hair_azimuthal(phi, p, s, gamma_o, gamma_t);
        sum = sum + hair_attenuation(p, f, t) * lobe;
    }
    return sum;
}

template <class T>
Vec3<T> hair_chiang_width(const HairFibre<T>& fibre, const Vec3<T>& to_light, const Vec3<T>& to_eye, int steps = 16) {
    Vec3<T> sum = splat3(T(0));
    for (int i = 0; i < steps; ++i) sum = sum + hair_chiang(fibre, to_light, to_eye, T(2 * i + 1) / T(steps) - T(1));
    return sum / T(steps);
}

}  // namespace kiln::reference
