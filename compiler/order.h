#pragma once
// Orders of axes that keep diagrams small. Everything here is deterministic: budgets are counts of work, never times.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compiler/diagram.h"

namespace kiln {

// FORCE (Aloul, Markov, Sakallah 2003): axes that occur together move towards each other. Returns order[level] = axis; the
// manifest's own order when nothing is gained.
std::vector<uint32_t> force_order(size_t axes, const std::vector<std::vector<uint32_t>>& together);

// The same sets in a diagram of their own, holding nothing else.
struct Reordered {
    std::unique_ptr<Diagram> diagram;
    std::vector<Set> sets;
};

// Rudell's sifting over these sets: each axis in turn is moved to the level where the sets take the fewest edges. Stops
// after about `budget` edge visits; with a budget of 0 the order stays and only nodes that the sets do not use are dropped.
Reordered sift(const Diagram& diagram, std::span<const Set> sets, size_t budget, size_t node_limit);

}  // namespace kiln
