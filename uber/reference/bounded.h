#pragma once
// A number with the largest error that a conforming Vulkan device may have made on the way to it: running error analysis
// (Higham, "Accuracy and Stability of Numerical Algorithms", 2002, section 3.3) with the fp32 rules of the Vulkan
// specification, "Precision of Individual Operations". A reference template run on Bounded gives the exact result and a
// bound on |device - exact| for exactly these inputs; no driver is asked.
//
//   + - *              correctly rounded, in any rounding mode: 1 ulp; a result under 2^-126 may become 0
//   a / b              2.5 ulp for 2^-126 <= |b| <= 2^126; above, anything from 0 to the quotient; else no bound
//   inversesqrt, sqrt  2 ulp; sqrt as 1 / inversesqrt
//   exp, exp2          (3 + 2 |x|) ulp
//   log, log2          3 ulp outside [0.5, 2], 2^-21 inside
//   pow                as exp2(y * log2(x))
//   sin, cos           2^-11 on [-pi, pi]; elsewhere no more than that they lie in [-1, 1]
//   atan               4096 ulp; asin and acos as the specification forms them from atan(y, x) and sqrt
//   mix                the worse of a (1 - t) + b t and a + t (b - a); a sum of products: in any order
//   min, max, clamp    the interval that holds the device's value, cut; so an unbounded value is bounded again by a clamp
//
// Compilers may also contract and reassociate where nothing is `precise` (Mesa does). A bound over every rewriting would be
// useless: it would hold for the cancelling forms too. Whoever compares a device with the bound multiplies it by
// `reassociation_margin`, which covers sums taken in another order and fused or factored products.
//
// Comparisons decide by value. Where the device may decide otherwise, decision_was_close is raised.
// Errors may be infinite (no bound holds), never NaN; a value that does not exist is 0 with an infinite error.

#include <cfloat>
#include <limits>

#include "uber/reference/numbers.h"

namespace kiln::reference {

inline constexpr double reassociation_margin = 2;

// Raised by a comparison, floor or the like of values closer than their errors; cleared by whoever wants to know.
inline thread_local bool decision_was_close = false;

struct Bounded {
    double value = 0, error = 0;
    Bounded() = default;
    Bounded(double v, double e) : value(v), error(e) {}
    // A constant of the shader's text, rounded to fp32.
    explicit Bounded(double constant)
        : Bounded(constant, std::fabs(static_cast<double>(static_cast<float>(constant)) - constant)) {}
    explicit Bounded(int constant) : Bounded(static_cast<double>(constant)) {}
    // What a shader reads from memory: exact, but that a denormal may read as 0.
    static Bounded input(float x) {
        const double v = static_cast<double>(x);
        return {v, std::fabs(v) < 0x1p-126 ? std::fabs(v) : 0};
    }
    double low() const { return std::isinf(error) ? -error : value - error; }
    double high() const { return std::isinf(error) ? error : value + error; }
};

inline double value(const Bounded& x) { return x.value; }

namespace bounds {

inline constexpr double ulp = 0x1p-23;  // of x, at most ulp |x|
inline constexpr double least = 0x1p-126, most = FLT_MAX;
inline constexpr double infinity = std::numeric_limits<double>::infinity();

// `value` exact, reached with operands that are off by what makes `passed_on`, then rounded with `ulps`, or `absolute`.
inline Bounded rounded(double value, double passed_on, double ulps, double absolute = 0) {
    if (std::isnan(value)) return {0, infinity};
    const double reach = std::fabs(value) + passed_on;
    double error = passed_on + std::max(ulps * ulp * reach, absolute);
    if (std::fabs(value) - error < least && reach > 0) error += std::min(reach, least) + std::max(ulps, 1.0) * 0x1p-149;
    if (!(std::fabs(value) + error <= most)) error = infinity;
    return {value, error};
}

// Of a value that lies in [low, high] on the device.
inline Bounded within(double value, double low, double high) {
    const double error = std::max(high - value, value - low);
    return {value, std::isnan(error) ? infinity : std::max(error, 0.0)};
}

inline bool decide(bool by_value, const Bounded& a, const Bounded& b) {
    const double together = a.error + b.error;
    if (together > 0 && !(std::fabs(a.value - b.value) > together)) decision_was_close = true;
    return by_value;
}

// Of f, which only steps.
template <class F>
Bounded stepped(const Bounded& x, F f) {
    if (!(f(x.low()) == f(x.high()))) decision_was_close = true;
    return {f(x.value), 0};
}

}  // namespace bounds

inline Bounded operator-(const Bounded& a) { return {-a.value, a.error}; }
inline Bounded operator+(const Bounded& a, const Bounded& b) { return bounds::rounded(a.value + b.value, a.error + b.error, 1); }
inline Bounded operator-(const Bounded& a, const Bounded& b) { return bounds::rounded(a.value - b.value, a.error + b.error, 1); }
inline Bounded operator*(const Bounded& a, const Bounded& b) {
    const double passed_on = std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error;
    return bounds::rounded(a.value * b.value, std::isnan(passed_on) ? bounds::infinity : passed_on, 1);
}
inline Bounded operator/(const Bounded& a, const Bounded& b) {
    const double quotient = a.value / b.value, size = std::fabs(b.value), nearest = size - b.error;
    if (!(nearest >= bounds::least)) return bounds::rounded(quotient, bounds::infinity, 0);
    const double passed_on = (a.error + std::fabs(quotient) * b.error) / nearest;
    if (size + b.error > 0x1p126) return bounds::rounded(quotient, std::fabs(quotient) + passed_on, 0);
    return bounds::rounded(quotient, passed_on, 2.5);
}
inline Bounded& operator+=(Bounded& a, const Bounded& b) { return a = a + b; }
inline Bounded& operator-=(Bounded& a, const Bounded& b) { return a = a - b; }
inline Bounded& operator*=(Bounded& a, const Bounded& b) { return a = a * b; }
inline Bounded& operator/=(Bounded& a, const Bounded& b) { return a = a / b; }

inline bool operator<(const Bounded& a, const Bounded& b) { return bounds::decide(a.value < b.value, a, b); }
inline bool operator>(const Bounded& a, const Bounded& b) { return bounds::decide(a.value > b.value, a, b); }
inline bool operator<=(const Bounded& a, const Bounded& b) { return bounds::decide(a.value <= b.value, a, b); }
inline bool operator>=(const Bounded& a, const Bounded& b) { return bounds::decide(a.value >= b.value, a, b); }
inline bool operator==(const Bounded& a, const Bounded& b) { return bounds::decide(a.value == b.value, a, b); }
inline bool operator!=(const Bounded& a, const Bounded& b) { return bounds::decide(a.value != b.value, a, b); }

inline Bounded min(const Bounded& a, const Bounded& b) {
    return bounds::within(std::fmin(a.value, b.value), std::min(a.low(), b.low()), std::min(a.high(), b.high()));
}
inline Bounded max(const Bounded& a, const Bounded& b) {
    return bounds::within(std::fmax(a.value, b.value), std::max(a.low(), b.low()), std::max(a.high(), b.high()));
}
inline Bounded clamp(const Bounded& x, const Bounded& low, const Bounded& high) {
    return bounds::within(std::fmin(std::fmax(x.value, low.value), high.value),
                          std::min(std::max(x.low(), low.low()), high.low()),
                          std::min(std::max(x.high(), low.high()), high.high()));
}
inline Bounded abs(const Bounded& x) { return {std::fabs(x.value), x.error}; }
inline Bounded floor(const Bounded& x) {
    return bounds::stepped(x, [](double v) { return std::floor(v); });
}
inline Bounded ceil(const Bounded& x) {
    return bounds::stepped(x, [](double v) { return std::ceil(v); });
}
inline int to_int(const Bounded& x) {
    return static_cast<int>(bounds::stepped(x, [](double v) { return std::trunc(v); }).value);
}

inline Bounded inversesqrt(const Bounded& x) {
    const double exact = 1 / std::sqrt(x.value);
    if (!(x.low() >= bounds::least)) return bounds::rounded(exact, bounds::infinity, 0);
    return bounds::rounded(exact, 1 / std::sqrt(x.low()) - exact, 2);
}
inline Bounded sqrt(const Bounded& x) {
    if (x.value < 0) return {0, bounds::infinity};
    const double exact = std::sqrt(x.value), low = x.low() < bounds::least ? 0 : std::sqrt(x.low());
    return bounds::rounded(exact, x.value == 0 && x.error == 0 ? 0 : std::max(exact - low, std::sqrt(x.high()) - exact), 4.5);
}
inline Bounded exp2(const Bounded& x) {
    const double exact = std::exp2(x.value);
    return bounds::rounded(exact, std::exp2(x.high()) - exact, 3 + 2 * (std::fabs(x.value) + x.error));
}
inline Bounded exp(const Bounded& x) {
    const double exact = std::exp(x.value);
    return bounds::rounded(exact, std::exp(x.high()) - exact, 3 + 2 * (std::fabs(x.value) + x.error));
}

namespace bounds {

// log is std::log or std::log2.
template <class F>
Bounded logarithm(const Bounded& x, F log) {
    const double exact = log(x.value);
    if (!(x.low() >= least)) return rounded(x.value > 0 ? exact : std::numeric_limits<double>::quiet_NaN(), infinity, 0);
    const bool inside = x.high() >= 0.5 && x.low() <= 2;
    return rounded(exact, exact - log(x.low()), 3, inside ? 0x1p-21 : 0);
}

template <class F>
Bounded wave(const Bounded& x, F f) {
    const double exact = f(x.value);
    // The fp32 number next to pi is above pi.
    if (!(std::fabs(x.value) + x.error <= 3.141593)) return {std::isnan(exact) ? 0 : exact, 2};
    return {exact, std::min(x.error + 0x1p-11, 2.0)};
}

}  // namespace bounds

inline Bounded log2(const Bounded& x) {
    return bounds::logarithm(x, [](double v) { return std::log2(v); });
}
inline Bounded log(const Bounded& x) {
    return bounds::logarithm(x, [](double v) { return std::log(v); });
}
inline Bounded pow(const Bounded& x, const Bounded& y) {
    const double exact = std::pow(x.value, y.value);
    if (x.value < 0 || !(y.low() > 0 || x.low() >= bounds::least)) return bounds::rounded(exact, bounds::infinity, 0);
    if (x.low() >= bounds::least) return {exact, exp2(y * log2(x)).error};
    if (x.value == 0 && x.error == 0) return {0, 0};
    // The base may be 0 on the device; the power is then 0, and at most what the upper end gives.
    const Bounded top = exp2(y * log2(Bounded(std::max(x.high(), bounds::least), 0)));
    return bounds::within(exact, 0, top.high());
}
inline Bounded sin(const Bounded& x) {
    return bounds::wave(x, [](double v) { return std::sin(v); });
}
inline Bounded cos(const Bounded& x) {
    return bounds::wave(x, [](double v) { return std::cos(v); });
}
inline Bounded tan(const Bounded& x) { return sin(x) / cos(x); }
inline Bounded sinh(const Bounded& x) { return (exp(x) - exp(-x)) * Bounded(0.5); }
inline Bounded atan(const Bounded& x) { return bounds::rounded(std::atan(x.value), std::min(x.error, pi), 4096); }
// The angle moves by at most the distance moved over the least distance from the origin; through the origin or across the
// negative x axis it may be any.
inline Bounded atan(const Bounded& y, const Bounded& x) {
    const double exact = std::atan2(y.value, x.value), moved = x.error + y.error, away = std::hypot(x.value, y.value) - moved;
    const bool cut = x.low() < 0 && y.low() <= 0 && y.high() >= 0 && y.error > 0;
    if (cut || !(away > 0)) return {exact, 2 * pi};
    return bounds::rounded(exact, std::min(moved / away, 2 * pi), 4096);
}
inline Bounded acos(const Bounded& x) {
    const Bounded formed = atan(sqrt(max(Bounded(1.0) - x * x, Bounded(0.0))), x);
    return std::fabs(x.value) <= 1 ? Bounded(std::acos(x.value), formed.error) : Bounded(0, bounds::infinity);
}
inline Bounded asin(const Bounded& x) {
    const Bounded formed = atan(x, sqrt(max(Bounded(1.0) - x * x, Bounded(0.0))));
    return std::fabs(x.value) <= 1 ? Bounded(std::asin(x.value), formed.error) : Bounded(0, bounds::infinity);
}

// Both forms read a, b and t twice: an error of theirs moves both readings at once. So forms are rounded from exact operands,
// and the operands' errors are passed on by the slopes 1 - t, t and b - a.
inline Bounded mix(const Bounded& a, const Bounded& b, const Bounded& t) {
    const Bounded from(a.value, 0), to(b.value, 0), at(t.value, 0);
    const Bounded weighted = from * (Bounded(1.0) - at) + to * at, stepped = from + at * (to - from);
    const double high = std::fabs(t.value) + t.error, low = std::fabs(1 - t.value) + t.error;
    const double moved = low * a.error + high * b.error + std::fabs(b.value - a.value) * t.error;
    // What the errors add to the operands is rounded as well.
    const double more = (std::fabs(a.value) + a.error) * low + (std::fabs(b.value) + b.error) * high -
                        std::fabs(a.value * (1 - t.value)) - std::fabs(b.value * t.value);
    const double error = std::max(weighted.error, stepped.error) + moved + 4 * bounds::ulp * more;
    return {weighted.value, std::isnan(error) ? bounds::infinity : error};
}

namespace bounds {

// The sum of n products, added in any order.
template <int n>
Bounded sum(const Bounded (&p)[n]) {
    double total = 0, passed_on = 0, magnitude = 0;
    for (const Bounded& x : p) {
        total += x.value;
        passed_on += x.error;
        magnitude += std::fabs(x.value) + x.error;
    }
    return rounded(total, passed_on + (n - 1) * ulp * magnitude, 0);
}

}  // namespace bounds

inline Bounded dot(const Vec2<Bounded>& a, const Vec2<Bounded>& b) {
    const Bounded products[] = {a.x * b.x, a.y * b.y};
    return bounds::sum(products);
}
inline Bounded dot(const Vec3<Bounded>& a, const Vec3<Bounded>& b) {
    const Bounded products[] = {a.x * b.x, a.y * b.y, a.z * b.z};
    return bounds::sum(products);
}
inline Bounded dot(const Vec4<Bounded>& a, const Vec4<Bounded>& b) {
    const Bounded products[] = {a.x * b.x, a.y * b.y, a.z * b.z, a.w * b.w};
    return bounds::sum(products);
}

// As v / length(v), which the specification names, or with inversesqrt, which drivers make of it.
inline Vec3<Bounded> normalize(const Vec3<Bounded>& v) {
    const Bounded squared = dot(v, v);
    const Vec3<Bounded> divided = v / sqrt(squared), scaled = v * inversesqrt(squared);
    const auto worse = [](const Bounded& a, const Bounded& b) { return Bounded(a.value, std::max(a.error, b.error)); };
    return {worse(scaled.x, divided.x), worse(scaled.y, divided.y), worse(scaled.z, divided.z)};
}

}  // namespace kiln::reference
