#pragma once
// Guards recursive compilers against texts that would overrun their stack.

#include <optional>
#include <string_view>

#include "compiler/toolchain/toolchain.h"

namespace kiln {

inline constexpr uint32_t max_operators = 2000;   // nested in one expression
inline constexpr uint32_t max_structures = 2000;  // in one text

// An error at the line where an expression becomes deeper than `max_operators`, or where the text declares one structure too
// many; nullopt when neither happens. `text` is GLSL without comments.
std::optional<ToolMessage> too_deep(std::string_view text);

}  // namespace kiln
