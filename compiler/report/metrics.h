#pragma once
// How far a picture x is from its reference r. All means run over every number of the picture (pixels times channels).
//
//   RMSE   = sqrt(mean (x - r)^2)
//   relMSE = mean (x - r)^2 / (r^2 + 0.01 mean(r)^2)
//   maxRel = max |x - r| / max(|r|, 1e-3 max |r|)
//   maxAbs = max |x - r|
//   bias   = mean(x - r) / mean(r)
//
// A number of x that is not finite is counted and left out of the rest; whoever ranks pictures must look at the count first.
// 0/0 is 0 (an exact black picture has no error) and anything else over 0 is infinite.

#include "compiler/report/picture.h"

namespace kiln::report {

struct Metrics {
    double relmse = 0, rmse = 0, max_rel = 0, max_abs = 0, bias = 0;
    double flip = 0;  // mean HDR-FLIP (flip.h), filled by whoever wants it
    uint64_t nonfinite = 0;
};

// x and r have one size. `region`: empty, or a flag a pixel; only flagged pixels count.
Metrics measure(const Picture& x, const Picture& r, const std::vector<bool>& region = {});

// How far those numbers may be off because r itself is only known with this variance, a number each (or empty: exact): what
// one standard deviation everywhere, in the worst direction, does to RMSE, relMSE and bias, and three of the worst number's to
// maxRel and maxAbs. Nothing is said of FLIP.
Metrics noise_of(const Metrics& measured, const Picture& r, const std::vector<double>& variance,
                 const std::vector<bool>& region = {});

// The same for what a member draws at random, another time in every pixel: two standard errors of the means over pixels.
// Nothing is said of maxima and of FLIP.
Metrics sampling_noise_of(const Metrics& measured, const Picture& x, const Picture& r, const std::vector<bool>& region = {});

}  // namespace kiln::report
