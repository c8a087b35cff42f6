#pragma once
// What passes between a GLSL function and its reference: how each type looks in GLSL, in a buffer of 32-bit words and as a
// C++ type over T (double, float or Bounded).

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "uber/reference/bounded.h"

namespace kiln::test {

template <class T>
T from_word(uint32_t word) {
    return static_cast<T>(std::bit_cast<float>(word));
}
template <>
inline reference::Bounded from_word<reference::Bounded>(uint32_t word) {
    return reference::Bounded::input(std::bit_cast<float>(word));
}

// Shapes of arguments. type<T>: what the reference takes; load: reads it and moves `at` on; read: the GLSL expression that
// makes it of the words from `first` of sample i, where word(k) is the GLSL text of word k.
struct Scalar {
    static constexpr uint32_t words = 1;
    static std::string glsl() { return "float"; }
    template <class T>
    using type = T;
    template <class T>
    static T load(const uint32_t*& at) {
        return from_word<T>(*at++);
    }
    static std::string read(uint32_t first) { return "kiln_float(" + std::to_string(first) + ")"; }
};

struct Integer {
    static constexpr uint32_t words = 1;
    static std::string glsl() { return "int"; }
    template <class T>
    using type = int;
    template <class T>
    static int load(const uint32_t*& at) {
        return static_cast<int>(*at++);
    }
    static std::string read(uint32_t first) { return "int(kiln_word(" + std::to_string(first) + "))"; }
};

struct Unsigned {
    static constexpr uint32_t words = 1;
    static std::string glsl() { return "uint"; }
    template <class T>
    using type = uint32_t;
    template <class T>
    static uint32_t load(const uint32_t*& at) {
        return *at++;
    }
    static std::string read(uint32_t first) { return "kiln_word(" + std::to_string(first) + ")"; }
};

// glsl(Part(first), Part(first + words of one), ...), n of them.
template <class Part>
std::string read_parts(const std::string& glsl, uint32_t first, uint32_t n) {
    std::string out = glsl + "(";
    for (uint32_t i = 0; i < n; ++i) out += (i == 0 ? "" : ", ") + Part::read(first + i * Part::words);
    return out + ")";
}

template <uint32_t n>
struct Vector;
#define KILN_VECTOR_SHAPE(n, Type, ...)                                                          \
    template <>                                                                                  \
    struct Vector<n> {                                                                           \
        static constexpr uint32_t words = n;                                                     \
        static std::string glsl() { return "vec" #n; }                                           \
        template <class T>                                                                       \
        using type = reference::Type<T>;                                                         \
        template <class T>                                                                       \
        static type<T> load(const uint32_t*& at) {                                               \
            const uint32_t* a = at;                                                              \
            at += n;                                                                             \
            return {__VA_ARGS__};                                                                \
        }                                                                                        \
        static std::string read(uint32_t first) { return read_parts<Scalar>(glsl(), first, n); } \
    };
KILN_VECTOR_SHAPE(2, Vec2, from_word<T>(a[0]), from_word<T>(a[1]))
KILN_VECTOR_SHAPE(3, Vec3, from_word<T>(a[0]), from_word<T>(a[1]), from_word<T>(a[2]))
KILN_VECTOR_SHAPE(4, Vec4, from_word<T>(a[0]), from_word<T>(a[1]), from_word<T>(a[2]), from_word<T>(a[3]))
#undef KILN_VECTOR_SHAPE

template <uint32_t n>
struct Matrix;
#define KILN_MATRIX_SHAPE(n, Type)                                                                  \
    template <>                                                                                     \
    struct Matrix<n> {                                                                              \
        static constexpr uint32_t words = n * n;                                                    \
        static std::string glsl() { return "mat" #n; }                                              \
        template <class T>                                                                          \
        using type = reference::Type<T>;                                                            \
        template <class T>                                                                          \
        static type<T> load(const uint32_t*& at) {                                                  \
            type<T> m;                                                                              \
            for (auto& column : m.columns) column = Vector<n>::template load<T>(at);                \
            return m;                                                                               \
        }                                                                                           \
        static std::string read(uint32_t first) { return read_parts<Vector<n>>(glsl(), first, n); } \
    };
KILN_MATRIX_SHAPE(3, Mat3)
KILN_MATRIX_SHAPE(4, Mat4)
#undef KILN_MATRIX_SHAPE

template <class Element, uint32_t n>
struct Array {
    static constexpr uint32_t words = n * Element::words;
    static std::string glsl() { return Element::glsl() + "[" + std::to_string(n) + "]"; }
    template <class T>
    using type = std::array<typename Element::template type<T>, n>;
    template <class T>
    static type<T> load(const uint32_t*& at) {
        type<T> out;
        for (auto& element : out) element = Element::template load<T>(at);
        return out;
    }
    static std::string read(uint32_t first) { return read_parts<Element>(glsl(), first, n); }
};

// Results: the GLSL type, and the suffixes that pick its floats in order.
struct ResultShape {
    std::string glsl;
    std::vector<std::string> picks;
};

template <class R>
struct ResultOf;
template <>
struct ResultOf<double> {
    static ResultShape shape() { return {"float", {""}}; }
};
template <>
struct ResultOf<reference::Vec2<double>> {
    static ResultShape shape() { return {"vec2", {".x", ".y"}}; }
};
template <>
struct ResultOf<reference::Vec3<double>> {
    static ResultShape shape() { return {"vec3", {".x", ".y", ".z"}}; }
};
template <>
struct ResultOf<reference::Vec4<double>> {
    static ResultShape shape() { return {"vec4", {".x", ".y", ".z", ".w"}}; }
};
template <class Element>
ResultShape repeated(const std::string& glsl, size_t n) {
    ResultShape out{glsl, {}};
    for (size_t i = 0; i < n; ++i)
        for (const std::string& pick : ResultOf<Element>::shape().picks)
            out.picks.push_back("[" + std::to_string(i) + "]" + pick);
    return out;
}
template <>
struct ResultOf<reference::Mat3<double>> {
    static ResultShape shape() { return repeated<reference::Vec3<double>>("mat3", 3); }
};
template <>
struct ResultOf<reference::Mat4<double>> {
    static ResultShape shape() { return repeated<reference::Vec4<double>>("mat4", 4); }
};
template <class E, size_t n>
struct ResultOf<std::array<E, n>> {
    static ResultShape shape() { return repeated<E>(ResultOf<E>::shape().glsl + "[" + std::to_string(n) + "]", n); }
};

template <class T>
void flatten(const T& x, T*& out) {
    *out++ = x;
}
template <class T>
void flatten(const reference::Vec2<T>& v, T*& out) {
    for (const T& x : {v.x, v.y}) *out++ = x;
}
template <class T>
void flatten(const reference::Vec3<T>& v, T*& out) {
    for (const T& x : {v.x, v.y, v.z}) *out++ = x;
}
template <class T>
void flatten(const reference::Vec4<T>& v, T*& out) {
    for (const T& x : {v.x, v.y, v.z, v.w}) *out++ = x;
}
template <class T>
void flatten(const reference::Mat3<T>& m, T*& out) {
    for (const auto& column : m.columns) flatten(column, out);
}
template <class T>
void flatten(const reference::Mat4<T>& m, T*& out) {
    for (const auto& column : m.columns) flatten(column, out);
}
template <class E, size_t n, class T>
void flatten(const std::array<E, n>& a, T*& out) {
    for (const E& element : a) flatten(element, out);
}

}  // namespace kiln::test
