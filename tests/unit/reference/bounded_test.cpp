// Bounded's promise: whatever a device does within Vulkan's precision rules lies inside; and its use: it is not much wider.

#include "uber/reference/bounded.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "uber/reference/cook_torrance.h"

namespace kiln::reference {
namespace {

std::mt19937_64 chance(2019);
double uniform(double low, double high) { return low + (high - low) * static_cast<double>(chance() >> 11) * 0x1p-53; }
float bits_to_float(uint32_t bits) {
    float x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

// A device at its worst: every operation errs as far as the rules allow, in a direction that chance or `drift` chooses.
struct Sloppy {
    double x = 0;  // always a float
    Sloppy() = default;
    explicit Sloppy(double constant) : x(static_cast<double>(static_cast<float>(constant))) {}
    explicit Sloppy(int constant) : Sloppy(static_cast<double>(constant)) {}
    static inline int drift = 0;  // -1, 0 (chance), 1
    static inline bool flushes = false;
};

double direction() { return Sloppy::drift != 0 ? Sloppy::drift : uniform(-1, 1); }
Sloppy flushed(double x) {
    Sloppy out;
    out.x = Sloppy::flushes && std::fabs(x) < 0x1p-126 ? 0 : x;
    return out;
}
double ulp_of(double x) { return std::exp2(std::floor(std::log2(std::max(std::fabs(x), 0x1p-126))) - 23); }
// Correctly rounded towards either neighbour.
Sloppy rounded(double x) {
    const float nearest = static_cast<float>(x);
    const double back = static_cast<double>(nearest);
    if (back == x) return flushed(x);
    const float below = back < x ? nearest : std::nextafter(nearest, -INFINITY);
    const float above = back > x ? nearest : std::nextafter(nearest, INFINITY);
    return flushed(static_cast<double>(direction() > 0 ? above : below));
}
// Within `ulps` of x, or `absolute`; a float, hence cut to one inside.
Sloppy within(double x, double ulps, double absolute = 0) {
    const double reach = std::max(ulps * ulp_of(x), absolute), target = x + direction() * reach;
    float f = static_cast<float>(target);
    if (std::fabs(static_cast<double>(f) - x) > reach) f = std::nextafter(f, static_cast<float>(x));
    return flushed(static_cast<double>(f));
}

Sloppy operator+(const Sloppy& a, const Sloppy& b) { return rounded(a.x + b.x); }
Sloppy operator-(const Sloppy& a, const Sloppy& b) { return rounded(a.x - b.x); }
Sloppy operator*(const Sloppy& a, const Sloppy& b) { return rounded(a.x * b.x); }
Sloppy operator/(const Sloppy& a, const Sloppy& b) { return within(a.x / b.x, 2.5); }
Sloppy min(const Sloppy& a, const Sloppy& b) { return a.x < b.x ? a : b; }
Sloppy max(const Sloppy& a, const Sloppy& b) { return a.x > b.x ? a : b; }
Sloppy abs(const Sloppy& a) { return flushed(std::fabs(a.x)); }
Sloppy inversesqrt(const Sloppy& a) { return within(1 / std::sqrt(a.x), 2); }
Sloppy sqrt(const Sloppy& a) { return a.x == 0 ? a : Sloppy(1.0) / inversesqrt(a); }
Sloppy exp2(const Sloppy& a) { return within(std::exp2(a.x), 3 + 2 * std::fabs(a.x)); }
Sloppy exp(const Sloppy& a) { return within(std::exp(a.x), 3 + 2 * std::fabs(a.x)); }
Sloppy log2(const Sloppy& a) { return a.x >= 0.5 && a.x <= 2 ? within(std::log2(a.x), 0, 0x1p-21) : within(std::log2(a.x), 3); }
Sloppy pow(const Sloppy& a, const Sloppy& b) { return exp2(b * log2(a)); }
Sloppy sin(const Sloppy& a) { return within(std::sin(a.x), 0, 0x1p-11); }
Sloppy atan(const Sloppy& y, const Sloppy& x) { return within(std::atan2(y.x, x.x), 4096); }
Sloppy acos(const Sloppy& a) { return atan(sqrt(Sloppy(1.0) - a * a), a); }
// Either form that a compiler may take.
Sloppy mix(const Sloppy& a, const Sloppy& b, const Sloppy& t) {
    return uniform(0, 1) < 0.5 ? a * (Sloppy(1.0) - t) + b * t : a + t * (b - a);
}

// Runs `f` on a float input by Bounded and by the sloppy device in all its moods.
template <class F>
double worst_share(F f, const std::vector<float>& in) {
    std::vector<Bounded> wide;
    std::vector<Sloppy> device;
    for (const float x : in) {
        wide.push_back(Bounded::input(x));
        device.push_back(Sloppy(static_cast<double>(x)));
    }
    const Bounded bound = f(wide);
    EXPECT_FALSE(std::isnan(bound.value) || std::isnan(bound.error));
    if (std::isinf(bound.error)) return 0;
    double worst = 0;
    for (const int drift : {-1, 0, 1, 0})
        for (const bool flushes : {false, true}) {
            Sloppy::drift = drift, Sloppy::flushes = flushes;
            const double off = std::fabs(f(device).x - bound.value);
            if (off > 0) worst = std::max(worst, off / bound.error);
        }
    return worst;
}

// A random expression tree of some depth over the inputs, the same for every number type.
struct Expression {
    std::vector<uint64_t> choices;
    explicit Expression(int length) {
        for (int i = 0; i < length; ++i) choices.push_back(chance());
    }
    template <class T>
    T operator()(const std::vector<T>& in) const {
        std::vector<T> stack = in;
        for (const uint64_t c : choices) {
            const T a = stack[(c >> 8) % stack.size()], b = stack[(c >> 24) % stack.size()];
            switch (c % 12) {
                case 0:
                case 1:
                    stack.push_back(a + b);
                    break;
                case 2:
                case 3:
                    stack.push_back(a - b);
                    break;
                case 4:
                case 5:
                    stack.push_back(a * b);
                    break;
                case 6:
                    stack.push_back(a / (T(0.25) + b * b));
                    break;
                case 7:
                    stack.push_back(sqrt(abs(a)));
                    break;
                case 8:
                    stack.push_back(exp2(clamp(a, T(-8), T(8))));
                    break;
                case 9:
                    stack.push_back(log2(max(abs(b), T(1e-3))));
                    break;
                case 10:
                    stack.push_back(mix(a, b, saturate(b)));
                    break;
                case 11:
                    stack.push_back(inversesqrt(a * a + T(1e-4)));
                    break;
            }
        }
        return stack.back();
    }
};

TEST(Bounded, HoldsForRandomExpressionsOnTheWorstDevice) {
    double worst = 0;
    for (int e = 0; e < 2000; ++e) {
        const Expression f(1 + e % 10);
        for (int i = 0; i < 10; ++i) {
            std::vector<float> in;
            for (int k = 0; k < 3; ++k) in.push_back(static_cast<float>(uniform(-1, 1) * std::pow(10, uniform(-6, 3))));
            const double share = worst_share(f, in);
            worst = std::max(worst, share);
            ASSERT_LE(share, 1 + 1e-9) << e << ": " << in[0] << " " << in[1] << " " << in[2];
        }
    }
    EXPECT_GT(worst, 0.5) << "the bound is far wider than what may happen";
}

template <class F>
double worst_over(F f, double low, double high, int arguments = 1) {
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        std::vector<float> in;
        for (int k = 0; k < arguments; ++k) in.push_back(static_cast<float>(uniform(low, high)));
        worst = std::max(worst, worst_share(f, in));
    }
    return worst;
}

// Each single operation: held, and used to more than half.
#define EXPECT_TIGHT(call)          \
    do {                            \
        const double share = call;  \
        EXPECT_LE(share, 1 + 1e-9); \
        EXPECT_GT(share, 0.5);      \
    } while (false)

TEST(Bounded, IsTightForSingleOperations) {
    EXPECT_TIGHT(worst_over([](const auto& x) { return x[0] + x[1]; }, -2, 2, 2));
    EXPECT_TIGHT(worst_over([](const auto& x) { return x[0] * x[1]; }, -2, 2, 2));
    EXPECT_TIGHT(worst_over([](const auto& x) { return x[0] / x[1]; }, 0.1, 3, 2));
    EXPECT_TIGHT(worst_over([](const auto& x) { return sqrt(x[0]); }, 0, 9));
    EXPECT_TIGHT(worst_over([](const auto& x) { return inversesqrt(x[0]); }, 0, 9));
    EXPECT_TIGHT(worst_over([](const auto& x) { return exp2(x[0]); }, -20, 20));
    EXPECT_TIGHT(worst_over([](const auto& x) { return exp(x[0]); }, -20, 20));
    EXPECT_TIGHT(worst_over([](const auto& x) { return log2(x[0]); }, 0.01, 3));
    EXPECT_TIGHT(worst_over([](const auto& x) { return pow(x[0], x[1]); }, 0.01, 5, 2));
    EXPECT_TIGHT(worst_over([](const auto& x) { return sin(x[0]); }, -3.14, 3.14));
    EXPECT_TIGHT(worst_over([](const auto& x) { return atan(x[0], x[1]); }, -3, 3, 2));
    EXPECT_TIGHT(worst_over([](const auto& x) { return acos(x[0]); }, -0.99, 0.99));
    EXPECT_TIGHT(worst_over([](const auto& x) { return mix(x[0], x[1], x[2]); }, 0, 1, 3));
}

TEST(Bounded, HoldsForAllFloatsUnderOneOperation) {
    for (int i = 0; i < 200000; ++i) {
        const float a = bits_to_float(static_cast<uint32_t>(chance())), b = bits_to_float(static_cast<uint32_t>(chance()));
        if (!std::isfinite(a) || !std::isfinite(b)) continue;
        ASSERT_LE(worst_share([](const auto& x) { return x[0] + x[1]; }, {a, b}), 1 + 1e-9) << a << " " << b;
        ASSERT_LE(worst_share([](const auto& x) { return x[0] * x[1]; }, {a, b}), 1 + 1e-9) << a << " " << b;
        ASSERT_LE(worst_share([](const auto& x) { return sqrt(abs(x[0])); }, {a}), 1 + 1e-9) << a;
        const float size = std::fabs(b);
        if (size < 0x1p-126f || size > 0x1p126f) continue;
        ASSERT_LE(worst_share([](const auto& x) { return x[0] / x[1]; }, {a, b}), 1 + 1e-9) << a << " " << b;
    }
}

TEST(Bounded, IsNarrowForAWholeBrdf) {
    // Where nothing cancels the bound of a BRDF of some hundred operations stays under 2^-23 times a few hundred.
    for (int i = 0; i < 2000; ++i) {
        const auto direction_near = [](double spread) {
            return normalize(Vec3<double>{uniform(-spread, spread), uniform(-spread, spread), 1.0});
        };
        const auto input = [](const Vec3<double>& v) {
            return map(Vec3<Bounded>{Bounded(v.x), Bounded(v.y), Bounded(v.z)},
                       [](const Bounded& x) { return Bounded(x.value, 0); });
        };
        const Vec3<Bounded> n = input({0, 0, 1}), v = input(direction_near(1)), l = input(direction_near(1));
        const Vec3<Bounded> out =
            cook_torrance(n, v, l, splat3(Bounded(0.5)), splat3(Bounded(0.04)), Bounded(uniform(0.6, 1), 0));
        EXPECT_LT(out.x.error / out.x.value, 500 * bounds::ulp);
        EXPECT_GT(out.x.error / out.x.value, 5 * bounds::ulp);
    }
}

TEST(Bounded, NeverGivesNaN) {
    const Bounded zero(0.0), tiny = Bounded::input(1e-40f), huge = Bounded::input(3e38f), one(1.0);
    const Bounded nearly_zero = one - (one / Bounded(3.0)) * Bounded(3.0), negative(-1.0);
    const std::vector<Bounded> values = {zero,     tiny,       huge,        one,         nearly_zero,
                                         negative, one / zero, zero / zero, huge * huge, -(huge * huge)};
    for (const Bounded& a : values)
        for (const Bounded& b : values)
            for (const Bounded& r : {a + b,
                                     a - b,
                                     a * b,
                                     a / b,
                                     min(a, b),
                                     max(a, b),
                                     clamp(a, b, one),
                                     abs(a),
                                     sqrt(a),
                                     inversesqrt(a),
                                     exp2(a),
                                     exp(a),
                                     log2(a),
                                     log(a),
                                     pow(a, b),
                                     sin(a),
                                     cos(a),
                                     tan(a),
                                     atan(a),
                                     atan(a, b),
                                     acos(a),
                                     asin(a),
                                     mix(a, b, a),
                                     floor(a),
                                     fract(a),
                                     smoothstep(zero, one, a),
                                     dot(splat3(a), splat3(b)),
                                     normalize(splat3(a)).x}) {
                EXPECT_FALSE(std::isnan(r.value) || std::isnan(r.error));
                EXPECT_GE(r.error, 0);
            }
    EXPECT_TRUE(std::isinf((one / nearly_zero).error));
    EXPECT_TRUE(std::isinf(inversesqrt(nearly_zero).error));
    EXPECT_LT(sqrt(max(nearly_zero, zero)).error, 1e-2);
    EXPECT_EQ(saturate(one / zero).error, 1) << "anything in [0, 1]";
}

TEST(Bounded, CloseDecisionsAreRaised) {
    const Bounded third = Bounded(1.0) / Bounded(3.0), one = Bounded(1.0);
    const auto raised = [](auto f) {
        decision_was_close = false;
        f();
        return decision_was_close;
    };
    EXPECT_FALSE(raised([&] { return one < Bounded(2.0); }));
    EXPECT_FALSE(raised([&] { return one >= Bounded(1.0); })) << "both are exact";
    EXPECT_FALSE(raised([&] { return third < one; }));
    EXPECT_TRUE(raised([&] { return third * Bounded(3.0) < one; }));
    EXPECT_TRUE(raised([&] { return value(floor(third * Bounded(3.0))); }));
    EXPECT_FALSE(raised([&] { return value(floor(third)); }));
    EXPECT_FALSE(raised([&] { return value(max(third * Bounded(3.0), one)); })) << "max is continuous";
    EXPECT_TRUE(raised([&] { return to_int(third * Bounded(3.0)); }));
}

TEST(Bounded, ConstantsCarryTheirRounding) {
    EXPECT_EQ(Bounded(0.5).error, 0);
    EXPECT_NEAR(Bounded(0.1).error, 1.49e-9, 1e-11);
    EXPECT_EQ(Bounded(0.1).value, 0.1);
    EXPECT_EQ(Bounded::input(0.1f).error, 0);
    EXPECT_EQ(Bounded::input(1e-40f).error, static_cast<double>(1e-40f)) << "may read as 0";
}

}  // namespace
}  // namespace kiln::reference
