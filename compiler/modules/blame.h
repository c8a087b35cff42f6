#pragma once
// Turns tool messages about classes into diagnostics at the tokens' places, collapsed over variants (ARCHITECTURE.md, Errors).

#include <functional>
#include <string>
#include <vector>

#include "compiler/base/files.h"
#include "compiler/modules/modules.h"

namespace kiln {

// A message about one class of one stage.
struct ClassMessage {
    size_t stage = 0;  // index into the stages
    size_t of_class = 0;
    ToolMessage message;
};

// Reads lines of the files that Split::files names, each file once. `files` must outlive it.
SourceLines source_lines(Files& files, std::string folder);

// One diagnostic per distinct severity, place and message, sorted, with one note per shader:
//   "in 1,152 of 75,536 variants of surface: exactly when ibl && light == area"
// `at_least`: not every class was looked at. Past `limit` distinct errors the rest is only counted.
Diags blame(const std::vector<StageClasses>& stages, const std::vector<ClassMessage>& messages, const SourceLines& lines,
            bool at_least = false, size_t limit = 100);

}  // namespace kiln
