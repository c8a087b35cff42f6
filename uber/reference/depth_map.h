#pragma once
// Depth maps with comparison samplers, as Vulkan reads them: clamp to edge, LESS_OR_EQUAL, one level.

#include <cstddef>
#include <vector>

#include "uber/reference/bounded.h"

namespace kiln::reference {

// x known only to +- slack; for the types that carry no error, x.
inline double loosened(double x, double) { return x; }
inline float loosened(float x, double) { return x; }
inline Bounded loosened(const Bounded& x, double slack) { return {x.value, x.error + slack}; }

// A sampler may divide the way between two texels into 2^-subTexelPrecisionBits, of which Vulkan wants 4 and all drivers
// that we know have 8.
inline constexpr double texel_step = 1.0 / 256;

// A 2D map. map(uv, reference): bilinear, each of the four texels compared before weighting.
class DepthMap {
public:
    DepthMap(size_t width, size_t height, std::vector<float> texels)
        : width_(width), height_(height), texels_(std::move(texels)) {}
    size_t width() const { return width_; }
    size_t height() const { return height_; }
    const std::vector<float>& texels() const { return texels_; }

    double texel(long x, long y) const {
        const auto edge = [](long i, size_t n) { return std::clamp<long>(i, 0, static_cast<long>(n) - 1); };
        return static_cast<double>(
            texels_[static_cast<size_t>(edge(y, height_)) * width_ + static_cast<size_t>(edge(x, width_))]);
    }

    template <class T>
    T operator()(const Vec2<T>& uv, const T& reference) const {
        const T x = uv.x * T(static_cast<double>(width_)) - T(0.5), y = uv.y * T(static_cast<double>(height_)) - T(0.5);
        const T left = floor(x), top = floor(y);
        const long i = static_cast<long>(value(left)), j = static_cast<long>(value(top));
        const auto lit = [&](long a, long b) { return reference <= T(texel(a, b)) ? T(1) : T(0); };
        const T u = loosened(x - left, texel_step), v = loosened(y - top, texel_step);
        return mix(mix(lit(i, j), lit(i + 1, j), u), mix(lit(i, j + 1), lit(i + 1, j + 1), u), v);
    }

private:
    size_t width_, height_;
    std::vector<float> texels_;  // row after row
};

// A cube map whose faces (+x, -x, +y, -y, +z, -z) hold one depth each: what a look-up more than a texel off the edges of a
// face sees, whatever the filter.
struct FaceDepths {
    double depth[6] = {};

    template <class T>
    T operator()(const Vec3<T>& direction, const T& reference) const {
        const T x = abs(direction.x), y = abs(direction.y), z = abs(direction.z);
        const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
        const T& major = axis == 0 ? direction.x : axis == 1 ? direction.y : direction.z;
        return reference <= T(depth[2 * axis + (major < T(0) ? 1 : 0)]) ? T(1) : T(0);
    }
};

}  // namespace kiln::reference
