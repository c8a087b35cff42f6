#pragma once
// Variance shadow maps, as uber/lib/vsm.glsl names them. Where the shader sums over a table, the reference adds up texels.

#include <vector>

#include "uber/reference/shadow_receiver.h"

namespace kiln::reference {

template <class T>
Vec2<T> shadow_moments(const T& distance, const T& far, const T& reference) {
    const T q = distance / far - reference;
    return {q, q * q};
}
template <class T>
Vec2<T> shadow_moments(const T& distance, const T& far, const T& reference, const Vec2<T>& gradient) {
    const T q = distance / far - reference;
    return {q, q * q + dot(gradient, gradient) / T(12)};
}

template <class T>
T moments_variance(const Vec2<T>& moments, const T& least) {
    return max(moments.y - moments.x * moments.x, least);
}

template <class T>
T chebyshev_upper_bound(const Vec2<T>& moments, const T& t, const T& least) {
    // Continuous where t passes the mean: no decision. Divided by the variance, which has most of the error, once.
    const T beyond = max(t - moments.x, T(0));
    return T(1) / (T(1) + beyond * beyond / moments_variance(moments, least));
}

template <class T>
T reduce_light_bleeding(const T& lit, const T& amount) {
    return saturate((lit - amount) / (T(1) - amount));
}

// (m - p t) / (1 - p): what is left of the mean when the lit share at t is taken out.
template <class T>
T vssm_blocker(const Vec2<T>& moments, const T& t, const T& lit) {
    return lit > T(0.999) ? t : (moments.x - lit * t) / (T(1) - lit);
}

template <class T>
T vsm_factor(const Vec2<T>& moments, const T& distance, const T& far, const T& reference, const T& least, const T& bleeding) {
    return reduce_light_bleeding(chebyshev_upper_bound(moments, distance / far - reference, least), bleeding);
}

// average: callable (centre, width) in uv -> mean moments.
template <class T, class Average>
T vssm_factor(const Average& average, const Vec4<T>& clip, const T& size, const T& near, const T& far, const T& extent,
              const T& texel, const T& reference, const T& least, const T& bleeding) {
    const Vec4<T> place = shadow_coordinates(clip);
    if (!(place.w > T(0))) return T(1);
    const T receiver = clamp(clip.w, near, far);
    const T t = receiver / far - reference;
    const T search = max(size * (receiver - near) / (receiver * extent * near), texel);
    const Vec2<T> around = average(place.xy(), Vec2<T>{search, search});
    const T lit_around = chebyshev_upper_bound(around, t, least);
    if (lit_around > T(0.999)) return T(1);
    const T blocker = max((vssm_blocker(around, t, lit_around) + reference) * far, near);
    const T width = clamp(size * (receiver - blocker) / (blocker * extent * receiver), texel, search);
    return reduce_light_bleeding(chebyshev_upper_bound(average(place.xy(), Vec2<T>{width, width}), t, least), bleeding);
}

// moments: callable (uv, level) -> both moments; size: of level 0, in texels.
template <class T, class Moments>
Vec2<T> mip_average(const Moments& moments, int size, const Vec2<T>& centre, const Vec2<T>& width, const T& levels) {
    const T texels = max(max(width.x, width.y) * T(size), T(1));
    return moments(centre, min(log2(texels), levels - T(1)));
}
template <class T, class Moments>
T vssm_factor_mips(const Moments& moments, int moments_size, const T& levels, const Vec4<T>& clip, const T& size, const T& near,
                   const T& far, const T& extent, const T& texel, const T& reference, const T& least, const T& bleeding) {
    const auto average = [&](const Vec2<T>& centre, const Vec2<T>& width) {
        return mip_average(moments, moments_size, centre, width, levels);
    };
    return vssm_factor(average, clip, size, near, far, extent, texel, reference, least, bleeding);
}

// Summed-area tables: texel is a callable (x, y) -> sum of all texels up to (x, y), of a size x size table.
template <class T, class Texel>
Vec2<T> sat_corner(const Texel& texel, int x, int y) {
    return x > 0 && y > 0 ? texel(x - 1, y - 1) : Vec2<T>{T(0), T(0)};
}
template <class T, class Texel>
Vec2<T> sat_sum(const Texel& texel, int size, const Vec2<T>& place) {
    const Vec2<T> low = map(place, [](const T& p) { return floor(p); });
    const Vec2<T> part = place - low;
    const int x0 = static_cast<int>(value(low.x)), y0 = static_cast<int>(value(low.y));
    const int x1 = std::min(x0 + 1, size), y1 = std::min(y0 + 1, size);
    const auto across = [&](int y) {
        const Vec2<T> a = sat_corner<T>(texel, x0, y), b = sat_corner<T>(texel, x1, y);
        return Vec2<T>{mix(a.x, b.x, part.x), mix(a.y, b.y, part.x)};
    };
    const Vec2<T> top = across(y0), bottom = across(y1);
    return {mix(top.x, bottom.x, part.y), mix(top.y, bottom.y, part.y)};
}
template <class T, class Texel>
Vec2<T> sat_average(const Texel& texel, int size, const Vec2<T>& centre, const Vec2<T>& width) {
    const T side = T(size);
    const auto low_high = [&](const T& c, const T& w) {
        const T half = max(T(0.5) * w * side, T(0.5));
        const T middle = clamp(c * side, half, max(side - half, half));
        return Vec2<T>{clamp(middle - half, T(0), side), clamp(middle + half, T(0), side)};
    };
    const Vec2<T> x = low_high(centre.x, width.x), y = low_high(centre.y, width.y);
    const auto sum = [&](const T& u, const T& v) { return sat_sum(texel, size, Vec2<T>{u, v}); };
    const Vec2<T> all = sum(x.y, y.y) - sum(x.x, y.y) - sum(x.y, y.x) + sum(x.x, y.x);
    return all / (max(x.y - x.x, T(1e-3)) * max(y.y - y.x, T(1e-3)));
}

// A square map of moments, row after row.
struct MomentMap {
    int size = 0;
    std::vector<Vec2<double>> texels;
    const Vec2<double>& at(int x, int y) const {
        return texels[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)];
    }

    // Mean over a box of uv, kept inside the map and not smaller than a texel, each texel weighed by what the box covers of it.
    Vec2<double> average(const Vec2<double>& centre, const Vec2<double>& width) const {
        double low[2], high[2];
        const double c[2] = {centre.x, centre.y}, w[2] = {width.x, width.y};
        for (int k = 0; k < 2; ++k) {
            const double half = std::min(std::max(w[k] * size / 2, 0.5), size / 2.0);
            const double middle = std::min(std::max(c[k] * size, half), size - half);
            low[k] = middle - half, high[k] = middle + half;
        }
        Vec2<double> sum;
        for (int y = static_cast<int>(low[1]); y < size && y < high[1]; ++y)
            for (int x = static_cast<int>(low[0]); x < size && x < high[0]; ++x) {
                const double covered = (std::min(high[0], x + 1.0) - std::max(low[0], x + 0.0)) *
                                       (std::min(high[1], y + 1.0) - std::max(low[1], y + 0.0));
                sum = sum + at(x, y) * covered;
            }
        return sum / ((high[0] - low[0]) * (high[1] - low[1]));
    }
};

}  // namespace kiln::reference
