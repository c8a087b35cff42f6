#pragma once
// Random numbers and directions, as uber/lib/gi_sampling.glsl names them.

#include <cstdint>

#include "uber/reference/numbers.h"

namespace kiln::reference {

inline uint32_t gi_random_bits(uint32_t& state) {
    state = state * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

inline double gi_random(uint32_t& state) { return (gi_random_bits(state) >> 8) * 0x1p-24; }

template <class T>
void gi_basis(const Vec3<T>& n, Vec3<T>& t, Vec3<T>& b) {
    const T s = T(value(n.z) >= 0 ? 1 : -1);
    const T a = T(-1) / (s + n.z);
    const T c = n.x * n.y * a;
    t = {T(1) + s * n.x * n.x * a, s * c, -s * n.x};
    b = {c, s + n.y * n.y * a, -n.y};
}

template <class T>
Vec3<T> gi_cosine_direction(const Vec2<T>& u, const Vec3<T>& n) {
    Vec3<T> t, b;
    gi_basis(n, t, b);
    const Vec2<T> p = cos_sin_of_turn(u.y) * -sqrt(u.x);
    return t * p.x + b * p.y + n * sqrt(max(T(1) - u.x, T(0)));
}

template <class T>
Vec2<T> gi_hammersley(int i, int n, const Vec2<T>& shift) {
    uint32_t reversed = 0;
    for (int bit = 0; bit < 32; ++bit)
        if ((static_cast<uint32_t>(i) >> bit & 1) != 0) reversed |= 1u << (31 - bit);
    const T x = (T(i) + T(0.5)) / T(n) + shift.x, y = T((reversed >> 8) * 0x1p-24) + shift.y;
    return {x - floor(x), y - floor(y)};
}

}  // namespace kiln::reference
