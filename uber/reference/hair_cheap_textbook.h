#pragma once
// Kajiya and Kay's and Karis' hair, as published: in angles, and with its quotients where they are defined.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// cos^p of the angle between v and the cone that l is mirrored into: theta_v = -theta_l, so cos(theta_l + theta_v).
template <class T>
Vec3<T> hair_kajiya_kay_textbook(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const Vec3<T>& diffuse,
                                 const Vec3<T>& specular, const T& exponent) {
    const T theta_l = asin(clamp(dot(tangent, to_light), T(-1), T(1)));
    const T theta_v = asin(clamp(dot(tangent, to_eye), T(-1), T(1)));
    const T cone = cos(theta_l + theta_v);
    return diffuse * cos(theta_l) + specular * (value(cone) > 0 ? pow(cone, exponent) : T(0));
}

template <class T>
T hair_scheuermann_textbook(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const T& exponent) {
    const Vec3<T> h = to_light + to_eye;
    if (value(dot(h, h)) <= 1e-12) return T(0);
    const T th = dot(tangent, normalize(h));
    const T sine2 = T(1) - th * th;
    return value(sine2) > 0 ? pow(sine2, exponent / T(2)) : T(0);
}

template <class T>
T hair_gaussian_textbook(const T& x, const T& b) {
    return exp(-x * x / (T(2) * b * b)) / (sqrt(T(2 * pi)) * b);
}

template <class T>
T hair_schlick_textbook(const T& cosine) {
    const T f0 = T((1 - 1.55) * (1 - 1.55) / ((1 + 1.55) * (1 + 1.55)));
    return f0 + (T(1) - f0) * pow(T(1) - saturate(cosine), T(5));
}

template <class T>
Vec3<T> hair_karis_textbook(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const Vec3<T>& colour,
                            const T& roughness, const T& specular, const T& backlit) {
    const T theta_l = -asin(clamp(dot(tangent, to_light), T(-1), T(1)));
    const T theta_v = -asin(clamp(dot(tangent, to_eye), T(-1), T(1)));
    const T v_dot_l = dot(to_eye, to_light);
    const T cos_theta_d = max(cos((theta_l - theta_v) / T(2)), T(1e-3));
    const T both = cos(theta_l) * cos(theta_v);
    const T cos_phi = clamp((v_dot_l - sin(theta_l) * sin(theta_v)) / max(both, T(1e-6)), T(-1), T(1));
    const T half_phi = sqrt((T(1) + cos_phi) / T(2));
    const T r = clamp(roughness, T(1.0 / 255), T(1));
    const T b = r * r;
    const T along = sin(theta_l) + sin(theta_v);
    const T shift = T(0.035);

    Vec3<T> sum = splat3(T(0));
    const T alpha = T(-2) * shift;
    const T r_shift = T(2) * sin(alpha) * (cos(alpha) * half_phi * cos(theta_v) + sin(alpha) * sin(theta_v));
    if (value(half_phi) > 0) {
        const T lobe = hair_gaussian_textbook(along - r_shift, b * sqrt(T(2)) * half_phi) * half_phi / T(4);
        const T f = hair_schlick_textbook(sqrt(saturate(T(0.5) + v_dot_l / T(2))));
        sum = sum + splat3(lobe * f * T(2) * specular * mix(T(1), backlit, saturate(-v_dot_l)));
    }
    const T index = T(1.19) / cos_theta_d + T(0.36) * cos_theta_d;
    const T h = half_phi * (T(1) + (T(0.6) - T(0.8) * cos_phi) / index);
    const T f_tt = hair_schlick_textbook(cos_theta_d * sqrt(saturate(T(1) - h * h)));
    const T n_tt = exp(T(-3.65) * cos_phi - T(3.98));
    const T f_trt = hair_schlick_textbook(cos_theta_d / T(2));
    const T n_trt = exp(T(17) * cos_phi - T(16.78));
    const Vec3<T> base = map(colour, [](const T& c) { return clamp(c, T(1e-6), T(1)); });
    const T crossing = sqrt(saturate(T(1) - h * h / (index * index))) / (T(2) * cos_theta_d);
    const T tt = hair_gaussian_textbook(along - shift, b / T(2)) * n_tt * (T(1) - f_tt) * (T(1) - f_tt) * backlit;
    const T trt = hair_gaussian_textbook(along - T(4) * shift, b * T(2)) * n_trt * (T(1) - f_trt) * (T(1) - f_trt) * f_trt;
    return sum + map(base, [&](const T& c) { return pow(c, crossing) * tt + pow(c, T(0.8) / cos_theta_d) * trt; });
}

}  // namespace kiln::reference
