#pragma once
// The arguments at which a function is evaluated.

#include "tests/functions/function.h"

namespace kiln::test {

inline constexpr uint64_t sample_seed = 104;
inline constexpr uint32_t lattice_samples = 12000, random_samples = 16384, extreme_samples = 12000;  // at most

// One sample after another, function.words words each: a lattice, random points, combinations of extremes.
std::vector<uint32_t> make_samples(const FunctionTest& function);
// The random points alone: what an ordinary draw meets.
std::vector<uint32_t> random_arguments(const FunctionTest& function);

}  // namespace kiln::test
