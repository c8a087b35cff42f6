#pragma once
// Indirect light as a constant, as uber/lib/gi_ambient.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> ambient_radiance(const Vec3<T>& albedo, const Vec3<T>& irradiance, const T& open) {
    return albedo * irradiance * open / T(pi);
}

// e (1 - a^(n+1)) / (1 - a), and e (n + 1) for a = 1. Near 1 the numerator cancels: it is -expm1((n + 1) log a) there.
inline Vec3<double> interreflection_textbook(const Vec3<double>& emission, const Vec3<double>& albedo, int bounces) {
    return emission * map(albedo, [&](double a) {
               if (a == 1) return bounces + 1.0;
               return a == 0 ? 1.0 : -std::expm1((bounces + 1) * std::log(a)) / (1 - a);
           });
}
template <class T>
Vec3<T> interreflection(const Vec3<T>& emission, const Vec3<T>& albedo, int bounces) {
    return emission * map(albedo, [&](const T& a) {
               T sum = T(0), power = T(1);
               for (int bit = 16; bit >= 0; --bit) {
                   sum = sum + sum * power;
                   power = power * power;
                   if (((bounces + 1) >> bit & 1) != 0) {
                       sum = sum * a + T(1);
                       power = power * a;
                   }
               }
               return sum;
           });
}

template <class T>
Vec3<T> interreflection_limit(const Vec3<T>& emission, const Vec3<T>& albedo) {
    return emission / map(albedo, [](const T& a) { return max(T(1) - a, T(1e-6)); });
}

template <class T>
Vec3<T> multibounce_visibility(const T& visibility, const Vec3<T>& albedo) {
    return map(albedo, [&](const T& x) {
        const T a = T(2.0404) * x - T(0.3324), b = T(-4.7951) * x + T(0.6417), c = T(2.7552) * x + T(0.6903);
        return max(visibility, visibility * visibility * visibility * a + visibility * visibility * b + visibility * c);
    });
}

}  // namespace kiln::reference
