#pragma once
// SPIRV-Tools, in our own types. Every function may be called from several threads at once.

#include <string>
#include <vector>

#include "compiler/toolchain/spirv_reach.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

std::string spirv_version();  // "SPIRV-Tools v2023.1 ..."

// Removes dead functions, branches, globals and constants and, unless options.debug, inner names and lines; numbers ids
// afresh. Interface names stay (compiler/toolchain/spirv_names.h). Equal code gives equal words.
Result<Words> spirv_prune(WordView words, const Options& options);

// By options.optimise; the input is a pruned module.
Result<Words> spirv_optimise(WordView words, const Options& options);

// spirv-val's messages for the options' Vulkan version; empty: valid.
std::vector<ToolMessage> spirv_validate(WordView words, const Options& options);

// What SPIRV-Tools' parser says of a module; false when it is none. read_operands() is faster and knows fewer instructions.
bool spirv_parse(WordView words, const Options& options, ParsedModule& out);

// spirv-dis text, or an error when the words are no SPIR-V.
Result<std::string> spirv_disassemble(WordView words);

}  // namespace kiln
