#include "compiler/report/shown.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "compiler/device/png.h"

namespace kiln::report {

namespace {

uint8_t srgb(double linear) {
    const double c = std::clamp(linear, 0.0, 1.0);
    return static_cast<uint8_t>(std::lround(255.0 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055)));
}

bool finite(const Picture& x, size_t pixel) {
    return std::isfinite(x.rgb[3 * pixel]) && std::isfinite(x.rgb[3 * pixel + 1]) && std::isfinite(x.rgb[3 * pixel + 2]);
}

// Dark violet over teal to yellow; lightness grows all the way.
constexpr std::array<std::array<double, 3>, 6> ramp{
    {{20, 11, 52}, {66, 30, 110}, {50, 100, 142}, {32, 160, 134}, {122, 208, 81}, {253, 231, 37}}};

}  // namespace

Result<Bytes> shown(const Picture& x, const Picture& reference) {
    std::vector<double> sorted = reference.rgb;
    std::sort(sorted.begin(), sorted.end());
    const double white = sorted.empty() ? 1.0 : sorted[std::min(sorted.size() - 1, sorted.size() * 98 / 100)];
    const double scale = white > 0.0 ? 1.0 / white : 1.0;
    std::vector<uint8_t> rgb(x.rgb.size());
    for (size_t i = 0; i < x.pixels(); ++i)
        for (size_t c = 0; c < 3; ++c)
            rgb[3 * i + c] = finite(x, i) ? srgb(x.rgb[3 * i + c] * scale) : (c == 1 ? uint8_t{0} : uint8_t{255});
    return encode_png(rgb, x.width, x.height);
}

Result<Bytes> error_map(const Picture& x, const Picture& reference) {
    double largest = 0.0;
    for (const double v : reference.rgb) largest = std::max(largest, std::fabs(v));
    std::vector<uint8_t> rgb(x.rgb.size());
    for (size_t i = 0; i < x.pixels(); ++i) {
        if (!finite(x, i)) {
            rgb[3 * i] = rgb[3 * i + 2] = 255;
            continue;
        }
        double error = 0.0;
        for (size_t c = 0; c < 3; ++c) {
            const double r = reference.rgb[3 * i + c], d = std::fabs(x.rgb[3 * i + c] - r);
            if (d > 0.0) error = std::max(error, d / std::max({std::fabs(r), 1e-3 * largest, 1e-300}));
        }
        const double t = std::clamp((std::log10(std::max(error, 1e-30)) + 7.0) / 7.0, 0.0, 1.0) * (ramp.size() - 1);
        const size_t k = std::min(static_cast<size_t>(t), ramp.size() - 2);
        for (size_t c = 0; c < 3; ++c)
            rgb[3 * i + c] =
                static_cast<uint8_t>(std::lround(ramp[k][c] + (ramp[k + 1][c] - ramp[k][c]) * (t - static_cast<double>(k))));
    }
    return encode_png(rgb, x.width, x.height);
}

}  // namespace kiln::report
