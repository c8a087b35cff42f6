#pragma once
// Sets of one diagram as bytes: shared nodes once, children before parents. Reading needs a diagram of the same axes and order,
// and checks it; anything out of range makes the reader fail.

#include <vector>

#include "compiler/base/wire.h"
#include "compiler/space/diagram.h"

namespace kiln {

void write_sets(WireWriter& out, const Diagram& diagram, const std::vector<Set>& sets);
// False, with the reader failed, when the bytes do not fit the diagram.
bool read_sets(WireReader& in, Diagram& diagram, std::vector<Set>& sets);

}  // namespace kiln
