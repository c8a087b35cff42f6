#pragma once
// Scattering of a hair fibre after Chiang et al. 2016 as the papers print it: in angles, exponentials and powers; the
// longitudinal lobe with the logarithm of everything that overflows.

#include "uber/reference/hair.h"

namespace kiln::reference {

// The mean of Fresnel's two reflectances ((cos i - eta cos t) / (cos i + eta cos t))^2, ((eta cos i - cos t) / ...)^2.
template <class T>
T hair_fresnel_textbook(const T& cosine, const T& eta) {
    const T cos_t = sqrt(T(1) - (T(1) - cosine * cosine) / (eta * eta));
    const T across = (cosine - eta * cos_t) / (cosine + eta * cos_t);
    const T along = (eta * cosine - cos_t) / (eta * cosine + cos_t);
    return (across * across + along * along) / T(2);
}

template <class T>
T hair_variance_textbook(int p, const T& beta_m) {
    const T root = T(0.726) * beta_m + T(0.812) * beta_m * beta_m + T(3.7) * pow(beta_m, T(20));
    const T v = root * root;
    return max(p == 0 ? v : (p == 1 ? v / T(4) : T(4) * v), T(1e-5));
}

template <class T>
T hair_logistic_scale_textbook(const T& beta_n) {
    const T s = sqrt(T(pi / 8)) * (T(0.265) * beta_n + T(1.194) * beta_n * beta_n + T(5.372) * pow(beta_n, T(22)));
    return max(s, T(1e-3));
}

// log of exp(-si so / v) I0(x) / (2 v sinh(1/v)); 2 sinh(y) = exp(y) (1 - exp(-2y)).
template <class T>
T hair_longitudinal_textbook(const T& si, const T& ci, const T& so, const T& co, const T& v) {
    const T x = ci * co / v;
    const T log_i0 = x + log(bessel_i0_scaled_textbook(x));
    const T log_sinh = T(1) / v + log(T(1) - exp(T(-2) / v));
    return exp(log_i0 - si * so / v - log_sinh - log(v));
}

// The logistic exp(-x/s) / (s (1 + exp(-x/s))^2) over its own integral from -pi to pi.
template <class T>
T hair_azimuthal_textbook(const T& phi, int p, const T& s, const T& gamma_o, const T& gamma_t) {
    const T q = T(p);
    const T d = phi - (T(2) * q * gamma_t - T(2) * gamma_o + q * T(pi));
    const T x = abs(d - T(2 * pi) * floor(d / T(2 * pi) + T(0.5)));
    const auto cumulative = [&](const T& y) { return T(1) / (T(1) + exp(-y / s)); };
    const T e = exp(-x / s);
    return e / (s * (T(1) + e) * (T(1) + e)) / (cumulative(T(pi)) - cumulative(T(-pi)));
}

// Order by order; the last is the geometric series from order 3 on.
template <class T>
Vec3<T> hair_attenuation_textbook(int p, const T& f, const Vec3<T>& t) {
    return map(t, [&](const T& through) {
        if (p == 0) return f;
        const T in_and_out = (T(1) - f) * (T(1) - f);
        if (p == 1) return in_and_out * through;
        if (p == 2) return in_and_out * through * through * f;
        const T rest = T(1) - through * f;
        return value(rest) <= 0 ? T(0) : in_and_out * through * through * through * f * f / rest;
    });
}

template <class T>
Vec3<T> hair_transmittance_textbook(const Vec3<T>& absorption, const T& cos_gamma_t, const T& cos_theta_t) {
    return map(absorption, [&](const T& a) { return exp(-a * (T(2) * cos_gamma_t / cos_theta_t)); });
}

template <class T>
Vec3<T> hair_absorption_textbook(const Vec3<T>& colour, const T& b) {
    const T d = T(5.969) - T(0.215) * b + T(2.532) * b * b - T(10.73) * b * b * b + T(5.574) * b * b * b * b +
                T(0.245) * b * b * b * b * b;
    return map(colour, [&](const T& c) {
        const T x = log(clamp(c, T(1e-3), T(1))) / d;
        return x * x;
    });
}

template <class T>
Vec3<T> hair_chiang_textbook(const HairFibre<T>& fibre, const Vec3<T>& to_light, const Vec3<T>& to_eye, const T& h) {
    const auto off = [](const Vec3<T>& w) { return sqrt(w.y * w.y + w.z * w.z); };
    const T theta_o = atan(to_eye.x, off(to_eye));
    const T theta_i = atan(to_light.x, off(to_light));
    const auto azimuth = [](const Vec3<T>& w) { return value(w.y) == 0 && value(w.z) == 0 ? T(0) : atan(w.z, w.y); };
    const T phi = azimuth(to_light) - azimuth(to_eye);

    const T gamma_o = asin(h);
    const T sin_theta_t = sin(theta_o) / fibre.eta;
    const T cos_theta_t = sqrt(T(1) - sin_theta_t * sin_theta_t);
    const T gamma_t = asin(h * cos(theta_o) / sqrt(fibre.eta * fibre.eta - sin(theta_o) * sin(theta_o)));

    const T f = hair_fresnel_textbook(cos(theta_o) * cos(gamma_o), fibre.eta);
    const Vec3<T> t = hair_transmittance_textbook(fibre.absorption, cos(gamma_t), cos_theta_t);
    const T s = hair_logistic_scale_textbook(fibre.beta_n);
    const auto along = [&](int p, const T& turn) {
        const T tilted = theta_o + turn * fibre.tilt;
        return hair_longitudinal_textbook(sin(theta_i), cos(theta_i), sin(tilted), abs(cos(tilted)),
                                          hair_variance_textbook(p, fibre.beta_m));
    };
    const T turns[] = {T(-2), T(1), T(4)};
    Vec3<T> sum = hair_attenuation_textbook(3, f, t) * (along(3, T(0)) / T(2 * pi));
    for (int p = 0; p < 3; ++p) {
        const T lobe = along(p, turns[p]) * hair_azimuthal_textbook(phi, p, s, gamma_o, gamma_t);
        sum = sum + hair_attenuation_textbook(p, f, t) * lobe;
    }
    return sum;
}

template <class T>
Vec3<T> hair_chiang_width_textbook(const HairFibre<T>& fibre, const Vec3<T>& to_light, const Vec3<T>& to_eye, int steps = 16) {
    Vec3<T> sum = splat3(T(0));
    for (int i = 0; i < steps; ++i) sum = sum + hair_chiang_textbook(fibre, to_light, to_eye, T(2 * i + 1) / T(steps) - T(1));
    return sum / T(steps);
}

}  // namespace kiln::reference
