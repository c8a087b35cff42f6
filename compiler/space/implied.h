#pragma once
// Questions about a list of sets, one per rule, that must all hold at once.

#include <span>
#include <vector>

#include "compiler/space/diagram.h"

namespace kiln {

// For each set, whether all the others together are contained in it; sets that are everything count as implied. The order
// of `allowed` should be from the deepest level upwards. Linear in the number of sets but for one walk each over what the
// others leave; the diagram's node limit bounds it (look at exhausted()).
std::vector<bool> implied_by_others(Diagram& diagram, std::span<const Set> allowed);

// Indices, ascending, of sets that have no common member though every proper subset of them has: a smallest such choice
// where one, two or (of up to 64 sets) three suffice, else one from which nothing can be dropped. All together must have
// no common member.
std::vector<uint32_t> smallest_clash(Diagram& diagram, std::span<const Set> allowed);

}  // namespace kiln
