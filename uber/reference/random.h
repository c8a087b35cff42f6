#pragma once
// Random numbers and means for the Monte Carlo ground truths: the same on every platform and for every seed.

#include <cmath>
#include <cstdint>
#include <limits>

#include "uber/reference/numbers.h"

namespace kiln::reference {

// O'Neill's PCG-XSH-RR 64/32 (2014); seed chooses the stream.
class Random {
public:
    explicit Random(uint64_t seed) : increment_(seed * 2 + 1) { next(), state_ += 0x853c49e6748fea9bu, next(); }

    // In [0, 1), 53 bits.
    double operator()() {
        const uint64_t high = next() >> 5, low = next() >> 6;
        return static_cast<double>((high << 26) | low) * 0x1p-53;
    }

private:
    uint32_t next() {
        const uint64_t old = state_;
        state_ = old * 6364136223846793005u + increment_;
        const auto xor_shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
        const auto turn = static_cast<uint32_t>(old >> 59);
        return (xor_shifted >> turn) | (xor_shifted << ((32 - turn) & 31));
    }
    uint64_t state_ = 0;
    uint64_t increment_;
};

// A Monte Carlo result. Whoever shows the mean shows its standard error.
struct Estimate {
    double mean = 0;
    double standard_error = 0;
};

// The mean of samples and its standard error (Welford's running form).
class Samples {
public:
    void add(double x) {
        ++count_;
        const double d = x - mean_;
        mean_ += d / static_cast<double>(count_);
        squares_ += d * (x - mean_);
    }
    Estimate estimate() const {
        const auto n = static_cast<double>(count_);
        return {mean_, count_ < 2 ? std::numeric_limits<double>::infinity() : std::sqrt(squares_ / (n - 1) / n)};
    }

private:
    uint64_t count_ = 0;
    double mean_ = 0;
    double squares_ = 0;
};

// Uniform on the unit sphere.
inline Vec3<double> random_direction(Random& random) {
    const double z = 2 * random() - 1, phi = 2 * pi * random(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// About n with density cos / pi.
inline Vec3<double> random_cosine(Random& random, const Vec3<double>& n) {
    const Vec3<double> d = n + random_direction(random);
    const double square = dot(d, d);
    return square > 1e-24 ? d / std::sqrt(square) : n;
}

}  // namespace kiln::reference
