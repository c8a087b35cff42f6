#pragma once
// Seeded numbers: a hash of (seed, name, index) in place of a generator with state, so that no value depends on the order in
// which others were made.

#include <cmath>
#include <cstdint>
#include <string_view>

namespace kiln {

inline uint64_t mix64(uint64_t x) {  // splitmix64's finaliser
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

inline uint64_t seed_of(uint64_t seed, std::string_view name) {
    uint64_t h = mix64(seed);
    for (const char c : name) h = mix64(h ^ static_cast<uint8_t>(c));
    return h;
}

// In [0, 1), a multiple of 2^-24.
inline float unit(uint64_t seed, uint64_t index) { return static_cast<float>(mix64(seed ^ mix64(index)) >> 40) * 0x1p-24f; }

// An ordinary number: in [0.1, 1), or with either sign.
inline float ordinary(uint64_t seed, uint64_t index, bool either_sign) {
    const float v = 0.1f + 0.9f * unit(seed, index);
    return either_sign && (mix64(seed ^ mix64(index ^ 0x517cc1b727220a95ULL)) & 1) != 0 ? -v : v;
}

}  // namespace kiln
