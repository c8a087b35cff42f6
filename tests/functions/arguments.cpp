#include "tests/functions/arguments.h"

#include <algorithm>
#include <cfloat>
#include <cstdlib>

#include <gtest/gtest.h>

namespace kiln::test {

namespace {

using reference::cross;
using reference::dot;
using reference::normalize;
using reference::pi;
using Direction = reference::Vec3<double>;

uint32_t word(double x) { return std::bit_cast<uint32_t>(static_cast<float>(x)); }

void put(const Direction& v, uint32_t* words) { words[0] = word(v.x), words[1] = word(v.y), words[2] = word(v.z); }

// The unit vector at an angle from n, turned about it.
Direction turned(const Direction& n, double cosine, double sine, double turn) {
    const Direction across = std::fabs(n.z) < 0.9 ? Direction{0, 0, 1} : Direction{1, 0, 0};
    const Direction t = normalize(cross(across, n)), b = cross(n, t);
    return normalize(n * cosine + t * (sine * std::cos(turn)) + b * (sine * std::sin(turn)));
}

// `count` numbers of the range.
Domain numbers(const Range& range, uint32_t count) {
    Domain out;
    out.dimensions = count;
    out.inside = [range, count](const double* point, const Known&, uint32_t* words) {
        for (uint32_t i = 0; i < count; ++i) words[i] = std::bit_cast<uint32_t>(range.inside(point[i]));
    };
    const uint32_t n = static_cast<uint32_t>(range.extremes.size());
    // All components alike, then every one another way through the list.
    out.extremes = count == 1 ? n : 4 * n;
    out.extreme = [range, count, n](uint32_t which, const Known&, uint32_t* words) {
        const uint32_t stride = which / n;
        for (uint32_t i = 0; i < count; ++i) words[i] = std::bit_cast<uint32_t>(range.extremes[(which + i * stride * 7) % n]);
    };
    return out;
}

void add(Range& range, float x) {
    if (x >= range.low && x <= range.high && std::find_if(range.extremes.begin(), range.extremes.end(), [x](float y) {
                                                 return std::bit_cast<uint32_t>(x) == std::bit_cast<uint32_t>(y);
                                             }) == range.extremes.end())
        range.extremes.push_back(x);
}

void add_with_neighbours(Range& range, float x) {
    add(range, x);
    add(range, std::nextafter(x, -FLT_MAX));
    add(range, std::nextafter(x, FLT_MAX));
}

Range range_of(double low, double high, std::function<double(double)> inside) {
    Range out;
    out.low = static_cast<float>(low), out.high = static_cast<float>(high);
    out.inside = [inside, l = out.low, h = out.high](double u) { return std::clamp(static_cast<float>(inside(u)), l, h); };
    for (const float end : {out.low, out.high}) add_with_neighbours(out, end);
    for (const float x : {0.0f, 0x1p-149f, 0x1p-127f, 0x1p-126f, 1e-20f, 0.5f, 1e10f, 1e30f}) {
        add(out, x);
        add(out, -x);
    }
    for (const float x : {-1.0f, 1.0f}) add_with_neighbours(out, x);
    return out;
}

}  // namespace

const uint32_t* Known::at(const std::string& name) const {
    const auto place = places_.find(name);
    if (place == places_.end()) {
        ADD_FAILURE() << "no earlier argument is called " << name;
        std::abort();
    }
    return words_ + place->second;
}

Range Range::also(std::initializer_list<double> more) const {
    Range out = *this;
    for (const double x : more) add_with_neighbours(out, static_cast<float>(x));
    return out;
}

Range Range::with(std::initializer_list<double> more) const {
    Range out = *this;
    for (const double x : more) out.extremes.push_back(static_cast<float>(x));
    return out;
}

Range linear(double low, double high) {
    return range_of(low, high, [=](double u) { return low + (high - low) * u; });
}
Range logarithmic(double low, double high) {
    return range_of(low, high, [=](double u) { return low * std::pow(high / low, u); });
}
Range either_sign(double low, double high) {
    return range_of(-high, high, [=](double u) {
        const double along = std::fabs(2 * u - 1);
        return u == 0.5 ? 0 : (u < 0.5 ? -1 : 1) * low * std::pow(high / low, along);
    });
}
Range finite() {
    Range out = range_of(-static_cast<double>(FLT_MAX), static_cast<double>(FLT_MAX), [](double) { return 0.0; });
    out.inside = [](double u) {
        const uint64_t finite_patterns = uint64_t{0xff} << 23;  // of either sign
        const uint64_t pattern =
            std::min(static_cast<uint64_t>(u * 2 * static_cast<double>(finite_patterns)), 2 * finite_patterns - 1);
        const uint32_t sign = pattern >= finite_patterns ? 0x80000000u : 0;
        return std::bit_cast<float>(sign | static_cast<uint32_t>(pattern % finite_patterns));
    };
    return out;
}
Range values(std::initializer_list<double> list) {
    Range out;
    out.low = -FLT_MAX, out.high = FLT_MAX;
    for (const double x : list) out.extremes.push_back(static_cast<float>(x));
    out.inside = [all = out.extremes](double u) {
        return all[std::min(static_cast<size_t>(u * static_cast<double>(all.size())), all.size() - 1)];
    };
    return out;
}

Argument<Scalar> number(std::string name, Range range) { return {std::move(name), numbers(range, 1)}; }
Argument<Vector<2>> vector2(std::string name, Range range) { return {std::move(name), numbers(range, 2)}; }
Argument<Vector<3>> vector3(std::string name, Range range) { return {std::move(name), numbers(range, 3)}; }
Argument<Vector<4>> vector4(std::string name, Range range) { return {std::move(name), numbers(range, 4)}; }
Argument<Vector<3>> colour(std::string name) { return vector3(std::move(name), linear(0, 1)); }
Argument<Matrix<3>> matrix3(std::string name, Range range) { return {std::move(name), numbers(range, 9)}; }
Argument<Matrix<4>> matrix4(std::string name, Range range) { return {std::move(name), numbers(range, 16)}; }

Argument<Vector<3>> unit(std::string name) {
    Domain out;
    out.dimensions = 2;
    out.inside = [](const double* point, const Known&, uint32_t* words) {
        const double z = 2 * point[0] - 1, r = std::sqrt(std::max(0.0, 1 - z * z)), turn = 2 * pi * point[1];
        put({r * std::cos(turn), r * std::sin(turn), z}, words);
    };
    static const std::vector<Direction> special = [] {
        std::vector<Direction> all;
        for (const double s : {-1.0, 1.0}) {
            for (const Direction& axis : {Direction{1, 0, 0}, Direction{0, 1, 0}, Direction{0, 0, 1}}) {
                all.push_back(axis * s);
                for (const double slip : {1e-20, 1e-7, 1e-4})
                    all.push_back(normalize(axis * s + Direction{axis.y, axis.z, axis.x} * slip));
            }
            for (const double y : {-1.0, 1.0}) all.push_back(normalize(Direction{1, y, s}));
            all.push_back(normalize(Direction{-1, 1, s}));
            all.push_back(normalize(Direction{1, 0, s}));
        }
        return all;
    }();
    out.extremes = static_cast<uint32_t>(special.size());
    out.extreme = [](uint32_t which, const Known&, uint32_t* words) { put(special[which], words); };
    return {std::move(name), out};
}

Argument<Vector<3>> hemisphere(std::string name, std::string n) {
    Domain out;
    out.dimensions = 2;
    out.inside = [n](const double* point, const Known& known, uint32_t* words) {
        const double z = point[0];
        put(turned(normalize(known.vector3(n)), z, std::sqrt(1 - z * z), 2 * pi * point[1]), words);
    };
    static constexpr double special[] = {0, 1e-20, 1e-7, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5, 0.9, 0.999, 0.999999, 1};
    out.extremes = 3 * static_cast<uint32_t>(std::size(special));
    out.extreme = [n](uint32_t which, const Known& known, uint32_t* words) {
        const double z = special[which / 3];
        put(turned(normalize(known.vector3(n)), z, std::sqrt(1 - z * z), 2.0 * (which % 3)), words);
        if (z == 1) put(known.vector3(n), words);
    };
    return {std::move(name), out};
}

Argument<Vector<3>> near(std::string name, std::string n, double reach, std::string scale) {
    const auto most = [=](const Known& known) { return std::min(pi, reach * (scale.empty() ? 1 : known.number(scale))); };
    Domain out;
    out.dimensions = 2;
    out.inside = [=](const double* point, const Known& known, uint32_t* words) {
        const double angle = most(known) * point[0] * point[0];
        put(turned(normalize(known.vector3(n)), std::cos(angle), std::sin(angle), 2 * pi * point[1]), words);
    };
    static constexpr double special[] = {0, 0.01, 0.1, 0.5, 1};
    constexpr uint32_t angles = static_cast<uint32_t>(std::size(special));
    out.extremes = angles + 4;
    out.extreme = [=](uint32_t which, const Known& known, uint32_t* words) {
        const Direction to = known.vector3(n);
        if (which < angles) {
            const double angle = most(known) * special[which];
            put(angle == 0 ? to : turned(normalize(to), std::cos(angle), std::sin(angle), 1.0), words);
            return;
        }
        put(to, words);  // one component moved by one float
        const uint32_t component = which - angles < 3 ? which - angles : 0;
        const float x = std::bit_cast<float>(words[component]);
        words[component] = std::bit_cast<uint32_t>(std::nextafter(x, which - angles < 3 ? 0.0f : 2.0f));
    };
    return {std::move(name), out};
}

Argument<Integer> integer(std::string name, int low, int high) {
    Domain out;
    out.dimensions = 1;
    const double count = static_cast<double>(high) - low + 1;
    out.inside = [=](const double* point, const Known&, uint32_t* words) {
        words[0] = static_cast<uint32_t>(low + static_cast<int>(std::min(point[0] * count, count - 1)));
    };
    out.extremes = 2;
    out.extreme = [=](uint32_t which, const Known&, uint32_t* words) {
        words[0] = static_cast<uint32_t>(which == 0 ? low : high);
    };
    return {std::move(name), out};
}

Argument<Unsigned> bits(std::string name) {
    Domain out;
    out.dimensions = 1;
    out.inside = [](const double* point, const Known&, uint32_t* words) {
        words[0] = static_cast<uint32_t>(std::min(point[0] * 0x1p32, 0x1p32 - 1));
    };
    static constexpr uint32_t special[] = {0, 1, 2, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff};
    out.extremes = static_cast<uint32_t>(std::size(special));
    out.extreme = [](uint32_t which, const Known&, uint32_t* words) { words[0] = special[which]; };
    return {std::move(name), out};
}

}  // namespace kiln::test
