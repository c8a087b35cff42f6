#pragma once
// Orders of axes that keep diagrams small. Everything here is deterministic: budgets are counts of work, never times.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compiler/space/diagram.h"

namespace kiln {

// One step of a condition: what it joins. Inputs are axes, or the number of axes plus the index of an earlier gate.
struct Gate {
    std::vector<uint32_t> inputs;
    bool compares = false;  // two axes with each other; otherwise every input contributes a truth value
};

// A first order from how the conditions are built. Returns order[level] = axis; the order written when no other is better.
std::vector<uint32_t> initial_order(const std::vector<uint32_t>& radices, const std::vector<Gate>& gates);

// The same sets in a diagram of their own, holding nothing else.
struct Reordered {
    std::unique_ptr<Diagram> diagram;
    std::vector<Set> sets;
};

// Rudell's sifting over these sets: each axis in turn is moved to the level where the sets take the fewest edges. Stops
// after about `budget` edge visits; with a budget of 0 the order stays and only nodes that the sets do not use are dropped.
// The old diagram is given up once its sets are copied, so that large ones are not held three times.
Reordered sift(std::unique_ptr<Diagram> diagram, std::span<const Set> sets, size_t budget, size_t node_limit);

}  // namespace kiln
