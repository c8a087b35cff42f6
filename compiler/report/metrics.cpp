#include "compiler/report/metrics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace kiln::report {

namespace {

double ratio(double over, double under) {
    if (over == 0.0) return 0.0;
    return under == 0.0 ? std::copysign(std::numeric_limits<double>::infinity(), over) : over / under;
}

}  // namespace

Metrics measure(const Picture& x, const Picture& r, const std::vector<bool>& region) {
    assert(x.rgb.size() == r.rgb.size());
    assert(region.empty() || region.size() == r.pixels());
    const auto counts = [&](size_t i) { return region.empty() || region[i / 3]; };
    Metrics out;
    double mean_r = 0.0, max_r = 0.0;
    size_t all = 0, n = 0;
    for (size_t i = 0; i < r.rgb.size(); ++i) {
        if (!counts(i)) continue;
        mean_r += r.rgb[i];
        max_r = std::max(max_r, std::fabs(r.rgb[i]));
        ++all;
    }
    if (all == 0) return out;
    mean_r /= static_cast<double>(all);

    double squares = 0.0, relative = 0.0, sum = 0.0, sum_r = 0.0;
    for (size_t i = 0; i < r.rgb.size(); ++i) {
        if (!counts(i)) continue;
        if (!std::isfinite(x.rgb[i])) {
            ++out.nonfinite;
            continue;
        }
        const double d = x.rgb[i] - r.rgb[i];
        squares += d * d;
        relative += ratio(d * d, r.rgb[i] * r.rgb[i] + 0.01 * mean_r * mean_r);
        out.max_rel = std::max(out.max_rel, ratio(std::fabs(d), std::max(std::fabs(r.rgb[i]), 1e-3 * max_r)));
        out.max_abs = std::max(out.max_abs, std::fabs(d));
        sum += d;
        sum_r += r.rgb[i];
        ++n;
    }
    if (n == 0) return out;
    out.rmse = std::sqrt(squares / static_cast<double>(n));
    out.relmse = relative / static_cast<double>(n);
    out.bias = ratio(sum, sum_r);
    return out;
}

Metrics noise_of(const Metrics& measured, const Picture& r, const std::vector<double>& variance,
                 const std::vector<bool>& region) {
    Metrics out;
    if (variance.empty()) return out;
    assert(variance.size() == r.rgb.size());
    const auto counts = [&](size_t i) { return region.empty() || region[i / 3]; };
    double mean_r = 0.0, max_r = 0.0;
    size_t n = 0;
    for (size_t i = 0; i < r.rgb.size(); ++i) {
        if (!counts(i)) continue;
        mean_r += r.rgb[i];
        max_r = std::max(max_r, std::fabs(r.rgb[i]));
        ++n;
    }
    if (n == 0) return out;
    mean_r /= static_cast<double>(n);
    double squares = 0.0, relative = 0.0;
    for (size_t i = 0; i < r.rgb.size(); ++i) {
        if (!counts(i)) continue;
        const double deviation = std::sqrt(variance[i]);
        squares += variance[i];
        relative += ratio(variance[i], r.rgb[i] * r.rgb[i] + 0.01 * mean_r * mean_r);
        out.max_rel = std::max(out.max_rel, ratio(3.0 * deviation, std::max(std::fabs(r.rgb[i]), 1e-3 * max_r)));
        out.max_abs = std::max(out.max_abs, 3.0 * deviation);
    }
    // Roots of means of squares are norms: the triangle's inequality.
    out.rmse = std::sqrt(squares / static_cast<double>(n));
    relative /= static_cast<double>(n);
    out.relmse = 2.0 * std::sqrt(relative * measured.relmse) + relative;
    out.bias = ratio(out.rmse, std::fabs(mean_r));
    return out;
}

Metrics sampling_noise_of(const Metrics& measured, const Picture& x, const Picture& r, const std::vector<bool>& region) {
    const auto counts = [&](size_t pixel) { return region.empty() || region[pixel]; };
    double mean_r = 0.0, n = 0.0;
    for (size_t i = 0; i < r.pixels(); ++i)
        if (counts(i)) mean_r += (r.rgb[3 * i] + r.rgb[3 * i + 1] + r.rgb[3 * i + 2]) / 3.0, ++n;
    Metrics out;
    if (n < 2.0) return out;
    mean_r /= n;
    // Channels of a pixel share its directions, so pixels are what is counted.
    double sum[3] = {}, squares[3] = {};
    for (size_t i = 0; i < r.pixels(); ++i) {
        if (!counts(i)) continue;
        double value[3] = {};
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double d = std::isfinite(x.rgb[c]) ? x.rgb[c] - r.rgb[c] : 0.0;
            value[0] += d * d / 3.0;
            value[1] += ratio(d * d, r.rgb[c] * r.rgb[c] + 0.01 * mean_r * mean_r) / 3.0;
            value[2] += d / 3.0;
        }
        for (size_t k = 0; k < 3; ++k) sum[k] += value[k], squares[k] += value[k] * value[k];
    }
    const auto error = [&](size_t k) { return std::sqrt(std::max(0.0, squares[k] / n - sum[k] * sum[k] / (n * n)) / (n - 1.0)); };
    out.rmse = ratio(error(0), measured.rmse);  // two errors of the square, over twice its root
    out.relmse = 2.0 * error(1);
    out.bias = ratio(2.0 * error(2), std::fabs(mean_r));
    return out;
}

}  // namespace kiln::report
