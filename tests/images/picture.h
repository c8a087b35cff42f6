#pragma once
// What the reference expects of every pixel, and how the device's picture is held against it.
//
// A pixel is left out (masked) where
//   - its 3 x 3 neighbourhood shows more than one body or face of it: a silhouette, which a device may draw a pixel to the side;
//     or the rim of a hole is within the alpha that a pixel's place may be off by;
//   - a decision of the reference (a shadow test, a texel of a texture that is not filtered) is closer than what rounding
//     and the grid of vertex positions allow to move it;
//   - the bound is over a tenth of the value: a pole of a formula, the very edge of a hard shadow.
// Everywhere else |device - reference| <= reassociation_margin times the bound that Vulkan's precision rules give
// (uber/reference/bounded.h). Nothing is fitted to a driver.

#include <functional>

#include "tests/images/scene.h"

namespace kiln::test {

inline constexpr uint32_t picture_size = 128;

// The scene's visible points.
struct Points {
    uint32_t size = 0;
    struct Point {
        int body = -1;  // -1: nothing
        bool silhouette = false, front = true;
        Bounded depth;
        reference::SurfaceVaryings<Bounded> in;
    };
    std::vector<Point> at;  // row after row
};
// holes: where the base map's alpha says so, nothing is drawn.
Points visible_points(const Scene& scene, uint32_t size = picture_size, bool holes = false);

// Of one pixel: the values of one output.
using Expect = std::function<std::vector<Bounded>(const Points::Point&)>;

struct Judged {
    size_t covered = 0, silhouettes = 0, close = 0, loose = 0, compared = 0, wrong = 0;  // pixels
    double worst = 0;                                                                    // error over allowed error
    double most = 0;                                                                     // error
    double relative = 0;  // root of the mean of squares, over the mean of squares of the reference
    std::string example;  // the worst one that is wrong
    double masked_share() const { return 1 - static_cast<double>(compared) / static_cast<double>(covered == 0 ? 1 : covered); }
};

// words: four a pixel (one for depth). skip_silhouettes: false when the points come from the device itself.
Judged judge(const Points& points, const Expect& expect, const ReadBack& got);

// "output 2", "depth"; null when there is none.
const ReadBack* output(const RunOutput& run, const std::string& what);

float as_float(uint32_t word);

// When KILN_IMAGES names a folder: <name>.png with the device's picture, the reference and their difference over the
// allowed one (white: at its limit; red: beyond) side by side.
void show(const std::string& name, const Points& points, const Expect& expect, const ReadBack& got);

}  // namespace kiln::test
