#pragma once
// Reads a compiler's log.

#include <string_view>
#include <vector>

#include "compiler/toolchain/toolchain.h"

namespace kiln {

// glslang's info log as messages: "ERROR: 0:12: 'x' : undeclared identifier". Counts of errors and other follow-ups are left
// out; lines that continue a message are joined to it; what has no line gets line 0.
std::vector<ToolMessage> read_messages(std::string_view log);

bool has_error(const std::vector<ToolMessage>& messages);

}  // namespace kiln
