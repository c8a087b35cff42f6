#pragma once
// Says a set of variants in words. The condition is exact over `care` (what lies outside is don't-care), names only axes
// that matter, and has at most four terms.

#include <string>

#include "compiler/space.h"

namespace kiln {

// "ibl && light == area", or empty when four terms do not suffice. `set` must be a subset of `care`. "always" when equal.
std::string describe_set(Space& space, Set set, Set care);

// The contract of DESIGN section 9:
//   "in 1,152 of 75,536 variants of surface: exactly when ibl && light == area"
//   "in 3 of 16 variants of sky: for example two_sided=true water=false"        (no short condition)
// `at_least` writes "in at least N of M ...", for when not every class was looked at.
std::string describe_condition(Space& space, Set set, Set care, bool at_least = false);

}  // namespace kiln
