#pragma once
// FLIP: the difference that a viewer sees who alternates between two pictures, in [0, 1] a pixel; 0 for equal ones.
//   LDR: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for Alternating
//        Images", Proc. ACM CGIT 3(2) (HPG), 2020.
//   HDR: Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered High Dynamic Range Images",
//        Eurographics Short Papers, 2021: the largest LDR value over a range of exposures, which the reference decides.

#include "compiler/base/jobs.h"
#include "compiler/report/picture.h"

namespace kiln::report {

// Pixels a degree of the paper's viewer: 0.7 m in front of a screen 0.7 m and 3840 pixels wide.
inline constexpr double flip_pixels_per_degree = 0.7 * 3840.0 / 0.7 * (3.14159265358979323846 / 180.0);

// One value a pixel. Both pictures are linear RGB and are limited to [0, 1] first.
std::vector<double> ldr_flip(const Picture& reference, const Picture& test, double pixels_per_degree = flip_pixels_per_degree);

struct Exposures {
    double start = 0, stop = 0;  // in stops
    uint32_t count = 2;
};
// From where the reference's brightest pixel to where its median comes out of the ACES curve at 0.85.
Exposures flip_exposures(const Picture& reference);

// One value a pixel. Not finite in the test: 1. Negative light counts as none.
std::vector<double> hdr_flip(const Picture& reference, const Picture& test, double pixels_per_degree = flip_pixels_per_degree);

// HDR-FLIP of many pictures against one, which is looked at only once.
class FlipReference {
public:
    FlipReference(const Picture& reference, const Jobs& jobs, double pixels_per_degree = flip_pixels_per_degree);
    ~FlipReference();
    std::vector<double> against(const Picture& test, const Jobs& jobs) const;
    struct Seen;

private:
    Exposures exposures_;
    double pixels_per_degree_;
    std::vector<Seen> seen_;  // an exposure each
};

double mean_of(const std::vector<double>& values);

}  // namespace kiln::report
