#pragma once
// Kajiya and Kay's and Karis' hair, as uber/lib/hair_cheap.glsl names it and in its forms; hair_cheap_textbook.h has the
// published ones.

#include "uber/reference/fading.h"

namespace kiln::reference {

template <class T>
Vec3<T> hair_kajiya_kay(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const Vec3<T>& diffuse,
                        const Vec3<T>& specular, const T& exponent) {
    const T tl = clamp(dot(tangent, to_light), T(-1), T(1)), tv = clamp(dot(tangent, to_eye), T(-1), T(1));
    const T sine_l = sqrt((T(1) - tl) * (T(1) + tl)), sine_v = sqrt((T(1) - tv) * (T(1) + tv));
    const T cone = clamp(sine_l * sine_v - tl * tv, T(0), T(1));
    return diffuse * sine_l + specular * (cone > T(0) ? pow(cone, exponent) : T(0));
}

template <class T>
T hair_scheuermann(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const T& exponent) {
    const Vec3<T> h = to_light + to_eye;
    const T square = dot(h, h);
    const T th = dot(tangent, h) * inversesqrt(max(square, T(1e-12)));
    const T sine2 = clamp((T(1) - th) * (T(1) + th), T(0), T(1));
    return square > T(1e-12) && sine2 > T(0) ? pow(sine2, exponent / T(2)) : T(0);
}

template <class T>
T hair_gaussian(const T& x, const T& b) {
    const T t = x / b;
    return fading(-t * t / T(2)) * T(0.3989422804) / b;
}

template <class T>
T hair_schlick(const T& cosine) {
    const T f0 = T(0.0465205690);
    const T x = T(1) - saturate(cosine), x2 = x * x;
    return f0 + (T(1) - f0) * (x2 * x2 * x);
}

template <class T>
Vec3<T> hair_karis(const Vec3<T>& tangent, const Vec3<T>& to_light, const Vec3<T>& to_eye, const Vec3<T>& colour,
                   const T& roughness, const T& specular, const T& backlit) {
    const T sine_l = -clamp(dot(tangent, to_light), T(-1), T(1)), sine_v = -clamp(dot(tangent, to_eye), T(-1), T(1));
    const T cos2_l = (T(1) - sine_l) * (T(1) + sine_l), cos2_v = (T(1) - sine_v) * (T(1) + sine_v);
    const T both = sqrt(cos2_l * cos2_v), v_dot_l = dot(to_eye, to_light);
    const T cos_theta_d = max(sqrt(saturate(T(0.5) + (both + sine_l * sine_v) / T(2))), T(1e-3));
    const T cos_phi = clamp((v_dot_l - sine_l * sine_v) / max(both, T(1e-6)), T(-1), T(1));
    const T half_phi = sqrt(saturate(T(0.5) + cos_phi / T(2)));
    const T r = clamp(roughness, T(1.0 / 255), T(1)), b = r * r;
    const T along = sine_l + sine_v, shift = T(0.035);

    const T sa = T(std::sin(-0.07)), ca = T(std::cos(-0.07));  // of constants: folded before any device
    const T x = along - T(2) * sa * (ca * half_phi * sqrt(cos2_v) + sa * sine_v);
    const T width = T(2) * b * half_phi;
    const T lobe_r = half_phi > T(0) ? fading(-x * x / max(width * width, T(1e-30))) * T(0.25 * 0.2820947918) / b : T(0);
    const T behind = mix(T(1), backlit, saturate(-v_dot_l));
    Vec3<T> sum = splat3(lobe_r * hair_schlick(sqrt(saturate(T(0.5) + v_dot_l / T(2)))) * T(2) * specular * behind);

    const T a = cos_theta_d / (T(1.19) + T(0.36) * cos_theta_d * cos_theta_d);
    const T h = half_phi * (T(1) + a * (T(0.6) - T(0.8) * cos_phi));
    const T f_tt = T(1) - hair_schlick(cos_theta_d * sqrt(saturate(T(1) - h * h)));
    const Vec3<T> base = map(colour, [](const T& c) { return clamp(c, T(1e-6), T(1)); });
    const T crossing = sqrt(saturate(T(1) - h * a * h * a)) / (T(2) * cos_theta_d);
    const T tt = hair_gaussian(along - shift, b / T(2)) * exp(T(-3.65) * cos_phi - T(3.98)) * f_tt * f_tt * backlit;
    const T f = hair_schlick(cos_theta_d / T(2));
    const T trt = hair_gaussian(along - T(4) * shift, T(2) * b) * exp(T(17) * cos_phi - T(16.78)) * (T(1) - f) * (T(1) - f) * f;
    // Powers of [0, 1]: clamped for Bounded, which does not know it where the exponent is uncertain.
    return sum + map(base, [&](const T& c) {
               return clamp(pow(c, crossing), T(0), T(1)) * tt + clamp(pow(c, T(0.8) / cos_theta_d), T(0), T(1)) * trt;
           });
}

}  // namespace kiln::reference
