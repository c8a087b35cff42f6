#pragma once
// Numeric literals as glslang 12 scans them.

#include <string_view>
#include <vector>

#include "compiler/split/lex.h"

namespace kiln {

struct NumberLiteral {
    struct Problem {
        const char* text;
        bool outside_conditionals;  // #if does not mind
    };
    Tok kind = Tok::number;         // Tok::integer: plain digits, which #if can evaluate
    size_t end = 0;                 // behind its last character
    std::vector<Problem> problems;  // at its beginning
};

// The literal at `begin`, where a digit stands, or a point and a digit.
NumberLiteral scan_number(std::string_view text, size_t begin);

}  // namespace kiln
