#pragma once
// What of a module its entry points reach.

#include <vector>

#include "compiler/base/bytes.h"

namespace kiln {

// One instruction of a parsed module: where it is, what it defines, and which of its words are ids.
struct ParsedInstruction {
    uint32_t at = 0;  // word offset in the module
    uint16_t op = 0, length = 0;
    uint32_t result = 0;             // 0: defines nothing
    uint32_t first_id = 0, ids = 0;  // a run in ParsedModule::id_words
};

struct ParsedModule {
    std::vector<ParsedInstruction> instructions;
    std::vector<uint32_t> id_words;  // word offsets in the module of all ids: types, results and operands
};

// A branch or switch on a constant, or decoration groups: what keep_reached() cannot look through.
bool has_constant_branch(WordView words, const ParsedModule& parsed);

// Drops functions that no entry point calls, and globals, types, constants, names and decorations that nothing left refers to;
// inputs that are never read leave the entry point's interface too, outputs stay. Numbers ids afresh by first appearance, so
// that equal code gives equal words. `parsed` is of `words`, which are valid SPIR-V.
Words keep_reached(WordView words, const ParsedModule& parsed);

}  // namespace kiln
