#pragma once
// Fills uniform blocks, storage blocks and push constants by their reflected members (policy: inputs.h).

#include "compiler/validate/device.h"

namespace kiln {

// The bytes of one block. `name` seeds the values together with each member's name.
Bytes fill_block(const Resource& block, uint64_t seed, bool either_sign);

// The type of each 32-bit word of a storage block: its members', uint32 where nothing is declared.
std::vector<BaseType> word_types(const Resource& block);

// Stores one element (a scalar, vector or matrix, column after column) at `at`, converted to the member's type and layout.
// `values` holds rows * columns numbers. Bytes beyond the block are not written.
void store_value(Bytes& block, size_t at, const Member& member, const double* values);

}  // namespace kiln
