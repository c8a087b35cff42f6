#pragma once
// Which words of a module are ids, for the instructions that shaders are made of.

#include "compiler/toolchain/spirv_reach.h"

namespace kiln {

// Fills `out`; false when an instruction is none of those that this knows (SPIRV-Tools' parser, ten times slower, knows all),
// or the words are no module. `words` are taken to be valid SPIR-V otherwise.
bool read_operands(WordView words, ParsedModule& out);

}  // namespace kiln
