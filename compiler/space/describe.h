#pragma once
// Says a set of variants in words. The condition is exact over `care` (what lies outside is don't-care), names only axes
// that matter, and has at most four terms.

#include <string>

#include "compiler/space/space.h"

namespace kiln {

// "ibl && light == area": an expression of the rules' grammar that holds on exactly the members of `set` among those of
// `care`. Terms: `ibl`, `!ibl`, `light == area`, `light != none`, `light in {a, b}`, `!(light in {a, b})`, `cascades <= 2`,
// `first == second`; joined by &&, or where one conjunction does not do, a || of conjunctions. Empty when four terms do not
// suffice. `set` must be a subset of `care`; "always" when they are equal, "never" when `set` is empty.
std::string describe_set(Space& space, Set set, Set care);

// The contract of ARCHITECTURE.md, Errors:
//   "in 1,152 of 75,536 variants of surface: exactly when ibl && light == area"
//   "in 3 of 16 variants of sky: for example two_sided=true water=false"        (no short condition)
//   "in 16 of 16 variants of sky: always"
// `at_least` is for when not every class was looked at: "in at least N of M ...: whenever ibl".
std::string describe_condition(Space& space, Set set, Set care, bool at_least = false);

}  // namespace kiln
