#pragma once
// GLSL's scalars, vectors and matrices as C++ templates over the number type T, so that one text of a formula is run in
// double (the reference), in float (to tell rounding from modelling) and in Bounded (bounded.h: a value with the largest
// error that Vulkan's precision rules allow it). Functions have GLSL's names and meanings (GLSL 4.60, chapter 8) and are
// defined wherever the mathematics is, also where GLSL leaves the result open; where even that ends, they give NaN.
//
// Matrices are stored by columns, as in GLSL. Literals in formulas are written T(0.5).

#include <algorithm>
#include <cmath>

namespace kiln::reference {

inline double value(double x) { return x; }
inline double value(float x) { return static_cast<double>(x); }

#define KILN_REFERENCE_UNARY(name)                        \
    inline double name(double x) { return std::name(x); } \
    inline float name(float x) { return std::name(x); }
KILN_REFERENCE_UNARY(sqrt)
KILN_REFERENCE_UNARY(exp)
KILN_REFERENCE_UNARY(exp2)
KILN_REFERENCE_UNARY(log)
KILN_REFERENCE_UNARY(log2)
KILN_REFERENCE_UNARY(sin)
KILN_REFERENCE_UNARY(cos)
KILN_REFERENCE_UNARY(tan)
KILN_REFERENCE_UNARY(asin)
KILN_REFERENCE_UNARY(acos)
KILN_REFERENCE_UNARY(atan)
KILN_REFERENCE_UNARY(sinh)
KILN_REFERENCE_UNARY(floor)
KILN_REFERENCE_UNARY(ceil)
#undef KILN_REFERENCE_UNARY
inline double abs(double x) { return std::fabs(x); }
inline float abs(float x) { return std::fabs(x); }
inline double pow(double x, double y) { return std::pow(x, y); }
inline float pow(float x, float y) { return std::pow(x, y); }
inline double atan(double y, double x) { return std::atan2(y, x); }
inline float atan(float y, float x) { return std::atan2(y, x); }
inline double inversesqrt(double x) { return 1.0 / std::sqrt(x); }
inline float inversesqrt(float x) { return 1.0f / std::sqrt(x); }
// NaN as either operand gives the other, as most devices do; GLSL leaves it open.
inline double min(double a, double b) { return std::fmin(a, b); }
inline float min(float a, float b) { return std::fmin(a, b); }
inline double max(double a, double b) { return std::fmax(a, b); }
inline float max(float a, float b) { return std::fmax(a, b); }
// GLSL's int(x).
inline int to_int(double x) { return static_cast<int>(x); }
inline int to_int(float x) { return static_cast<int>(x); }

inline constexpr double pi = 3.14159265358979323846;

template <class T>
struct Vec2 {
    T x{}, y{};
};
template <class T>
struct Vec3 {
    T x{}, y{}, z{};
    Vec2<T> xy() const { return {x, y}; }
};
template <class T>
struct Vec4 {
    T x{}, y{}, z{}, w{};
    Vec2<T> xy() const { return {x, y}; }
    Vec3<T> xyz() const { return {x, y, z}; }
};

template <class T>
Vec3<T> splat3(T a) {
    return {a, a, a};
}

// Component by component; scalar operands stand for a vector of them.
#define KILN_REFERENCE_OPERATOR(op)                              \
    template <class T>                                           \
    Vec2<T> operator op(const Vec2<T>& a, const Vec2<T>& b) {    \
        return {a.x op b.x, a.y op b.y};                         \
    }                                                            \
    template <class T>                                           \
    Vec2<T> operator op(const Vec2<T>& a, const T& b) {          \
        return {a.x op b, a.y op b};                             \
    }                                                            \
    template <class T>                                           \
    Vec2<T> operator op(const T& a, const Vec2<T>& b) {          \
        return {a op b.x, a op b.y};                             \
    }                                                            \
    template <class T>                                           \
    Vec3<T> operator op(const Vec3<T>& a, const Vec3<T>& b) {    \
        return {a.x op b.x, a.y op b.y, a.z op b.z};             \
    }                                                            \
    template <class T>                                           \
    Vec3<T> operator op(const Vec3<T>& a, const T& b) {          \
        return {a.x op b, a.y op b, a.z op b};                   \
    }                                                            \
    template <class T>                                           \
    Vec3<T> operator op(const T& a, const Vec3<T>& b) {          \
        return {a op b.x, a op b.y, a op b.z};                   \
    }                                                            \
    template <class T>                                           \
    Vec4<T> operator op(const Vec4<T>& a, const Vec4<T>& b) {    \
        return {a.x op b.x, a.y op b.y, a.z op b.z, a.w op b.w}; \
    }                                                            \
    template <class T>                                           \
    Vec4<T> operator op(const Vec4<T>& a, const T& b) {          \
        return {a.x op b, a.y op b, a.z op b, a.w op b};         \
    }                                                            \
    template <class T>                                           \
    Vec4<T> operator op(const T& a, const Vec4<T>& b) {          \
        return {a op b.x, a op b.y, a op b.z, a op b.w};         \
    }
KILN_REFERENCE_OPERATOR(+)
KILN_REFERENCE_OPERATOR(-)
KILN_REFERENCE_OPERATOR(*)
KILN_REFERENCE_OPERATOR(/)
#undef KILN_REFERENCE_OPERATOR

template <class T>
Vec2<T> operator-(const Vec2<T>& a) {
    return {-a.x, -a.y};
}
template <class T>
Vec3<T> operator-(const Vec3<T>& a) {
    return {-a.x, -a.y, -a.z};
}
template <class T>
Vec4<T> operator-(const Vec4<T>& a) {
    return {-a.x, -a.y, -a.z, -a.w};
}

// f applied to every component.
template <class T, class F>
Vec2<T> map(const Vec2<T>& a, F f) {
    return {f(a.x), f(a.y)};
}
template <class T, class F>
Vec3<T> map(const Vec3<T>& a, F f) {
    return {f(a.x), f(a.y), f(a.z)};
}
template <class T, class F>
Vec4<T> map(const Vec4<T>& a, F f) {
    return {f(a.x), f(a.y), f(a.z), f(a.w)};
}

template <class T>
T dot(const Vec2<T>& a, const Vec2<T>& b) {
    return a.x * b.x + a.y * b.y;
}
template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
T dot(const Vec4<T>& a, const Vec4<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
auto length(const V& v) {
    return sqrt(dot(v, v));
}
template <class V>
V normalize(const V& v) {
    return v * inversesqrt(dot(v, v));
}
template <class T>
Vec3<T> reflect(const Vec3<T>& incident, const Vec3<T>& n) {
    return incident - n * (T(2) * dot(n, incident));
}

template <class T>
T clamp(const T& x, const T& low, const T& high) {
    return min(max(x, low), high);
}
template <class T>
T saturate(const T& x) {
    return clamp(x, T(0), T(1));
}
template <class T>
Vec3<T> saturate(const Vec3<T>& v) {
    return map(v, [](const T& x) { return saturate(x); });
}
template <class T>
Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <class T>
Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
    return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class T>
T max_component(const Vec3<T>& c) {
    return max(max(c.x, c.y), c.z);
}
template <class T>
T mix(const T& a, const T& b, const T& t) {
    return a * (T(1) - t) + b * t;
}
template <class T>
Vec3<T> mix(const Vec3<T>& a, const Vec3<T>& b, const T& t) {
    return {mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t)};
}
template <class T>
T step(const T& edge, const T& x) {
    return x < edge ? T(0) : T(1);
}
template <class T>
T smoothstep(const T& low, const T& high, const T& x) {
    const T t = saturate((x - low) / (high - low));
    return t * t * (T(3) - T(2) * t);
}
template <class T>
T fract(const T& x) {
    return x - floor(x);
}

template <class T>
struct Mat3 {
    Vec3<T> columns[3];
};
template <class T>
struct Mat4 {
    Vec4<T> columns[4];
};
template <class T>
Vec3<T> operator*(const Mat3<T>& m, const Vec3<T>& v) {
    return m.columns[0] * v.x + m.columns[1] * v.y + m.columns[2] * v.z;
}
template <class T>
Vec4<T> operator*(const Mat4<T>& m, const Vec4<T>& v) {
    return m.columns[0] * v.x + m.columns[1] * v.y + m.columns[2] * v.z + m.columns[3] * v.w;
}

// Cosine and sine of turn whole turns less a half.
template <class T>
Vec2<T> cos_sin_of_turn(const T& turn) {
    const T angle = T(2 * pi) * (turn - T(0.5));
    return {cos(angle), sin(angle)};
}

}  // namespace kiln::reference
