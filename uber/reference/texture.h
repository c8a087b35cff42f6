#pragma once
// Textures as Vulkan's samplers read them: one level, with the errors that a sampler may make. Bounded coordinates give
// Bounded texels; where a texel hangs on a decision that was too close, decision_was_close is raised (bounded.h).

#include <array>

#include "uber/reference/depth_map.h"

namespace kiln::reference {

inline double error_of(double) { return 0; }
inline double error_of(float) { return 0; }
inline double error_of(const Bounded& x) { return x.error; }

enum class TextureWrap { repeat, clamp };

// Between the texels that texel(i, j) gives, x and y in texels from the first one's centre. Weights are off by the coordinates'
// errors and by what a sampler makes of them, and each pays for the steps that it weighs. Continuous, so that no decision is too
// close: where x or y may lie in the next cell, the steepest step of the cells about counts.
template <class T, class Texel>
T bilinear(const T& x, const T& y, const Texel& texel) {
    const double left = std::floor(value(x)), top = std::floor(value(y)), u = value(x) - left, v = value(y) - top;
    const long i = static_cast<long>(left), j = static_cast<long>(top);
    const double a = texel(i, j), b = texel(i + 1, j), c = texel(i, j + 1), d = texel(i + 1, j + 1);
    double across = std::max(std::fabs(b - a), std::fabs(d - c)), down = std::max(std::fabs(c - a), std::fabs(d - b));
    const auto straddles = [](double part, double error) { return part < error || part + error > 1; };
    if (straddles(u, error_of(x)) || straddles(v, error_of(y))) {
        const bool close = decision_was_close;
        for (long dy = -1; dy <= 2; ++dy)
            for (long dx = -1; dx <= 2; ++dx) {
                const double here = texel(i + dx, j + dy);
                if (dx < 2) across = std::max(across, std::fabs(texel(i + dx + 1, j + dy) - here));
                if (dy < 2) down = std::max(down, std::fabs(texel(i + dx, j + dy + 1) - here));
            }
        decision_was_close = close;  // texels about say how steep it is, no more
    }
    const double read = (a * (1 - u) + b * u) * (1 - v) + (c * (1 - u) + d * u) * v;
    const double rounding = 8 * bounds::ulp * std::max({std::fabs(a), std::fabs(b), std::fabs(c), std::fabs(d)});
    return loosened(T(read), (error_of(x) + texel_step) * across + (error_of(y) + texel_step) * down + rounding);
}

// A sampler may divide the way between two mips into 2^-mipmapPrecisionBits; lavapipe has 4, others more.
inline constexpr double level_step = 1.0 / 16;

// What at(level) gives, at a level between `levels` of them: between two, or of the nearest.
template <class T, class Level>
auto between_levels(const T& level, int levels, bool linear, const Level& at) {
    const T within = clamp(level, T(0), T(static_cast<double>(levels - 1)));
    if (!linear) return at(static_cast<int>(value(floor(within + T(0.5)))));
    const int low = std::min(static_cast<int>(value(within)), levels - 1), high = std::min(low + 1, levels - 1);
    const auto a = at(low), b = at(high);
    const T part = within - T(static_cast<double>(low));
    const T t =
        loosened(part, level_step + (value(part) < error_of(part) || value(part) + error_of(part) > 1 ? error_of(part) : 0));
    return a + (b - a) * t;
}

// Four floats a texel.
class Texture2D {
public:
    Texture2D() = default;
    Texture2D(long width, long height, std::vector<float> texels, bool linear, TextureWrap wrap)
        : width_(width), height_(height), texels_(std::move(texels)), linear_(linear), wrap_(wrap) {}
    long width() const { return width_; }
    long height() const { return height_; }
    const std::vector<float>& texels() const { return texels_; }
    bool linear() const { return linear_; }
    TextureWrap wrap() const { return wrap_; }

    double texel(long x, long y, size_t channel) const {
        const auto place = [&](long i, long n) {
            return wrap_ == TextureWrap::clamp ? std::clamp<long>(i, 0, n - 1) : (i % n + n) % n;
        };
        return static_cast<double>(texels_[static_cast<size_t>(place(y, height_) * width_ + place(x, width_)) * 4 + channel]);
    }

    template <class T>
    Vec4<T> operator()(const Vec2<T>& uv) const {
        return {channel(uv, 0), channel(uv, 1), channel(uv, 2), channel(uv, 3)};
    }
    template <class T>
    Vec3<T> rgb(const Vec2<T>& uv) const {
        return {channel(uv, 0), channel(uv, 1), channel(uv, 2)};
    }
    template <class T>
    T channel(const Vec2<T>& uv, size_t c) const {
        const T x = uv.x * T(static_cast<double>(width_)), y = uv.y * T(static_cast<double>(height_));
        if (!linear_) return T(texel(static_cast<long>(value(floor(x))), static_cast<long>(value(floor(y))), c));
        return bilinear(x - T(0.5), y - T(0.5), [&](long i, long j) { return texel(i, j, c); });
    }

private:
    long width_ = 0, height_ = 0;
    std::vector<float> texels_;
    bool linear_ = true;
    TextureWrap wrap_ = TextureWrap::clamp;
};

// Compares with LESS_OR_EQUAL, then filters. Continuous in uv; a texel that the reference is too close to counts as an error as
// large as its weight, so that a filter of many such looks still says something.
template <class T>
T filtered_comparison(const DepthMap& map, const Vec2<T>& uv, const T& reference) {
    const bool before = decision_was_close;
    double lit[4][4], close[4][4];
    const double x = value(uv.x) * static_cast<double>(map.width()) - 0.5,
                 y = value(uv.y) * static_cast<double>(map.height()) - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            decision_was_close = false;
            const T depth(map.texel(static_cast<long>(left) + i - 1, static_cast<long>(top) + j - 1));
            lit[j][i] = reference <= depth ? 1 : 0;
            close[j][i] = decision_was_close ? 1 : 0;
        }
    decision_was_close = before;
    const auto at = [](const double(&v)[4][4]) {
        return [&](long i, long j) { return v[std::clamp<long>(j + 1, 0, 3)][std::clamp<long>(i + 1, 0, 3)]; };
    };
    const T in_x = loosened(T(x - left), error_of(uv.x) * static_cast<double>(map.width())),
            in_y = loosened(T(y - top), error_of(uv.y) * static_cast<double>(map.height()));
    const T unsure = bilinear(in_x, in_y, at(close));
    return loosened(bilinear(in_x, in_y, at(lit)), value(unsure) + error_of(unsure));
}

// The depth that a sampler without a filter reads, within those of all texels that it may read.
template <class T>
T nearest_depth(const DepthMap& map, const Vec2<T>& uv) {
    const auto range = [](const T& u, size_t n) {
        const double at = value(u) * static_cast<double>(n), reach = error_of(u) * static_cast<double>(n);
        const auto whole = [](double x) { return static_cast<long>(std::floor(x)); };
        return std::array<long, 3>{whole(at - reach), whole(at), whole(at + reach)};
    };
    const auto x = range(uv.x, map.width()), y = range(uv.y, map.height());
    const double read = map.texel(x[1], y[1]);
    double apart = 0;
    for (long j = y[0]; j <= y[2]; ++j)
        for (long i = x[0]; i <= x[2]; ++i) apart = std::max(apart, std::fabs(map.texel(i, j) - read));
    return loosened(T(read), apart);
}

// Face +x, -x, +y, -y, +z, -z of a direction and where it meets that, [0, 1]^2. Vulkan specification, "Cube Map Face
// Selection".
template <class T>
struct CubePlace {
    size_t face = 0;
    Vec2<T> uv;
};
template <class T>
CubePlace<T> cube_place(const Vec3<T>& d) {
    const T x = abs(d.x), y = abs(d.y), z = abs(d.z);
    const int axis = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
    const T& major = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
    const bool negative = value(major) < 0;
    const T s = axis == 0 ? (negative ? d.z : -d.z) : axis == 1 ? d.x : (negative ? -d.x : d.x);
    const T t = axis == 1 ? (negative ? -d.z : d.z) : -d.y;
    return {static_cast<size_t>(2 * axis + (negative ? 1 : 0)),
            {(s / abs(major) + T(1)) * T(0.5), (t / abs(major) + T(1)) * T(0.5)}};
}

// A depth cube with faces +x, -x, +y, -y, +z, -z. Within a texel of a face's edge filters reach into the next face: there
// the decision counts as close.
class DepthCube {
public:
    DepthCube() = default;
    explicit DepthCube(std::vector<DepthMap> faces) : faces_(std::move(faces)) {}
    const std::vector<DepthMap>& faces() const { return faces_; }

    template <class T>
    T operator()(const Vec3<T>& d, const T& reference) const {
        const CubePlace<T> place = cube_place(d);
        const DepthMap& face = faces_[place.face];
        const Vec2<T>& uv = place.uv;
        const double margin = 1.5 / static_cast<double>(face.width());
        for (const T& u : {uv.x, uv.y})
            if (value(u) < margin || value(u) > 1 - margin) decision_was_close = true;
        return filtered_comparison(face, uv, reference);
    }

private:
    std::vector<DepthMap> faces_;
};

// An array of cube maps with mips, four floats a texel: mip after mip, layer after layer, face after face. Edges are seamless.
class CubeArray {
public:
    CubeArray() = default;
    CubeArray(long side, int levels, int layers, std::vector<float> texels, bool linear)
        : side_(side), levels_(levels), layers_(layers), texels_(std::move(texels)), linear_(linear) {}
    long side() const { return side_; }
    int levels() const { return levels_; }
    int layers() const { return layers_; }
    const std::vector<float>& texels() const { return texels_; }
    bool linear() const { return linear_; }

    template <class T>
    Vec3<T> operator()(const Vec3<T>& d, int layer, const T& level) const {
        const CubePlace<T> place = cube_place(d);
        return between_levels(level, levels_, linear_, [&](int l) {
            const long n = side_ >> l;
            const Vec2<T> at{place.uv.x * T(static_cast<double>(n)), place.uv.y * T(static_cast<double>(n))};
            const auto channel = [&](size_t c) {
                if (linear_)
                    return bilinear(at.x - T(0.5), at.y - T(0.5),
                                    [&](long i, long j) { return texel(l, layer, place.face, i, j, c); });
                const auto inside = [&](const T& x) { return std::clamp<long>(static_cast<long>(value(floor(x))), 0, n - 1); };
                return T(texel(l, layer, place.face, inside(at.x), inside(at.y), c));
            };
            return Vec3<T>{channel(0), channel(1), channel(2)};
        });
    }

    // Beyond one edge of a face lies the texel of the next face that touches there; beyond two, where three faces meet, devices
    // differ: a close decision.
    double texel(int level, int layer, size_t face, long i, long j, size_t c) const {
        const long n = side_ >> level;
        const auto out = [&](long k) { return k < 0 || k >= n; };
        if (out(i) && out(j)) {
            decision_was_close = true;
            return texel(level, layer, face, std::clamp<long>(i, 0, n - 1), std::clamp<long>(j, 0, n - 1), c);
        }
        if (out(i) || out(j)) {
            const auto along = [&](long k) {
                return k < 0 ? -1 - 1e-9 : k >= n ? 1 + 1e-9 : 2 * (static_cast<double>(k) + 0.5) / static_cast<double>(n) - 1;
            };
            const double s = along(i), t = along(j);
            const Vec3<double> directions[] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
            const CubePlace<double> next = cube_place(directions[face]);
            const auto whole = [&](double u) {
                return std::clamp<long>(static_cast<long>(u * static_cast<double>(n)), 0, n - 1);
            };
            return texel(level, layer, next.face, whole(next.uv.x), whole(next.uv.y), c);
        }
        size_t first = 0;
        for (int l = 0; l < level; ++l) first += static_cast<size_t>((side_ >> l) * (side_ >> l) * 6 * layers_);
        const size_t image = static_cast<size_t>(layer) * 6 + face, texels_a_face = static_cast<size_t>(n * n);
        return static_cast<double>(texels_[(first + image * texels_a_face + static_cast<size_t>(j * n + i)) * 4 + c]);
    }

private:
    long side_ = 0;
    int levels_ = 0, layers_ = 0;
    std::vector<float> texels_;
    bool linear_ = true;
};

// A mip chain of moments in two channels.
class MomentMips {
public:
    MomentMips() = default;
    explicit MomentMips(std::vector<Texture2D> levels) : levels_(std::move(levels)) {}
    const std::vector<Texture2D>& levels() const { return levels_; }

    template <class T>
    Vec2<T> operator()(const Vec2<T>& uv, const T& level) const {
        return between_levels(level, static_cast<int>(levels_.size()), levels_.front().linear(), [&](int l) {
            const Texture2D& t = levels_[static_cast<size_t>(l)];
            return Vec2<T>{t.channel(uv, 0), t.channel(uv, 1)};
        });
    }

private:
    std::vector<Texture2D> levels_;
};

}  // namespace kiln::reference
