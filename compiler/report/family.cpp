#include "compiler/report/family.h"

#include <cmath>

namespace kiln::report {

double Reference::standard_error() const {
    double mean = 0.0, square = 0.0;
    for (const double v : picture.rgb) mean += v / static_cast<double>(picture.rgb.size());
    for (const double v : variance) square += v / static_cast<double>(variance.size());
    return mean > 0.0 ? std::sqrt(square) / mean : 0.0;
}

void mark_random(Family& family, const std::vector<std::string>& prefixes) {
    for (Member& m : family.members)
        for (const std::string& prefix : prefixes)
            if (m.name.starts_with(prefix)) m.random = true;
}

Reference per_point(const Points& points, uint32_t width, uint32_t height, const Effort& effort,
                    const std::function<Vec3d(size_t)>& value) {
    Reference out;
    out.picture = Picture(width, height);
    effort.jobs.each(height, [&](size_t y) {
        for (size_t i = y * width; i < (y + 1) * width && i < points.count(); ++i) {
            const Vec3d v = value(i);
            out.picture.rgb[3 * i] = v.x;
            out.picture.rgb[3 * i + 1] = v.y;
            out.picture.rgb[3 * i + 2] = v.z;
        }
    });
    return out;
}

}  // namespace kiln::report
