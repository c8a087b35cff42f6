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
        return between(x - T(0.5), y - T(0.5), c);
    }

private:
    // Bilinear. Continuous, so that no decision is too close: where x or y may lie in the next cell, the error takes in the
    // steepest slope of the cells about.
    template <class T>
    T between(const T& x, const T& y, size_t c) const {
        const double left = std::floor(value(x)), top = std::floor(value(y));
        const long i = static_cast<long>(left), j = static_cast<long>(top);
        const T u = loosened(x - T(left), texel_step), v = loosened(y - T(top), texel_step);
        const auto at = [&](long dx, long dy) { return T(texel(i + dx, j + dy, c)); };
        const T inside = mix(mix(at(0, 0), at(1, 0), u), mix(at(0, 1), at(1, 1), u), v);
        const auto straddles = [](const T& t) { return value(t) < error_of(t) || value(t) + error_of(t) > 1; };
        if (!straddles(x - T(left)) && !straddles(y - T(top))) return inside;
        double steepest = 0;
        for (long dy = -1; dy <= 2; ++dy)
            for (long dx = -1; dx <= 2; ++dx) {
                const double here = texel(i + dx, j + dy, c);
                if (dx < 2) steepest = std::max(steepest, std::fabs(texel(i + dx + 1, j + dy, c) - here));
                if (dy < 2) steepest = std::max(steepest, std::fabs(texel(i + dx, j + dy + 1, c) - here));
            }
        return loosened(inside, 2 * steepest * (error_of(x) + error_of(y)));
    }

    long width_ = 0, height_ = 0;
    std::vector<float> texels_;
    bool linear_ = true;
    TextureWrap wrap_ = TextureWrap::clamp;
};

// Compares with LESS_OR_EQUAL, then filters. Where all texels about agree it does not matter between which of them one is.
template <class T>
T filtered_comparison(const DepthMap& map, const Vec2<T>& uv, const T& reference) {
    const bool before = decision_was_close;
    decision_was_close = false;
    const T lit = map(uv, reference);
    if (decision_was_close) {
        decision_was_close = false;
        const auto place = [](const T& u, size_t n) {
            return static_cast<long>(std::floor(value(u) * static_cast<double>(n) - 0.5));
        };
        int count = 0;
        for (long y = -1; y <= 2; ++y)
            for (long x = -1; x <= 2; ++x)
                count += reference <= T(map.texel(place(uv.x, map.width()) + x, place(uv.y, map.height()) + y)) ? 1 : 0;
        if (count != 0 && count != 16) decision_was_close = true;
        if (!decision_was_close) {
            decision_was_close = before;
            return count == 16 ? T(1) : T(0);
        }
    }
    decision_was_close = decision_was_close || before;
    return lit;
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
        const T x = abs(d.x), y = abs(d.y), z = abs(d.z);
        const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
        const T& major = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
        const bool negative = value(major) < 0;
        // Vulkan specification, "Cube Map Face Selection".
        const T s = axis == 0 ? (negative ? d.z : -d.z) : axis == 1 ? d.x : (negative ? -d.x : d.x);
        const T t = axis == 1 ? (negative ? -d.z : d.z) : -d.y;
        const DepthMap& face = faces_[static_cast<size_t>(2 * axis + (negative ? 1 : 0))];
        const Vec2<T> uv{(s / abs(major) + T(1)) * T(0.5), (t / abs(major) + T(1)) * T(0.5)};
        const double margin = 1.5 / static_cast<double>(face.width());
        for (const T& u : {uv.x, uv.y})
            if (value(u) < margin || value(u) > 1 - margin) decision_was_close = true;
        return filtered_comparison(face, uv, reference);
    }

private:
    std::vector<DepthMap> faces_;
};

}  // namespace kiln::reference
