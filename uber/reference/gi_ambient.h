#pragma once
// Indirect light as a constant, as uber/lib/gi_ambient.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> ambient_radiance(const Vec3<T>& albedo, const Vec3<T>& irradiance, const T& open) {
    return albedo * irradiance * open / T(pi);
}

// e (1 - a^(n+1)) / (1 - a), and e (n + 1) for a = 1.
template <class T>
Vec3<T> interreflection(const Vec3<T>& emission, const Vec3<T>& albedo, int bounces) {
    return emission * map(albedo, [&](const T& a) {
               if (value(a) == 1) return T(bounces + 1);
               if (value(a) == 0) return T(1);
               // Near 1 the numerator cancels: it is -expm1((n + 1) log a) there.
               return T(-std::expm1((bounces + 1) * std::log(value(a))) / (1 - value(a)));
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
