#pragma once
// A token stream as the text that glslang gets, one token a line, and where each line comes from.

#include <string>
#include <vector>

#include "compiler/split/include.h"

namespace kiln {

struct ClassText {
    std::string text;
    std::vector<TextPlace> places;
};

// `version` is the #version line, or empty. With `layout` tokens of one source line share a line and #line tells which.
ClassText write_class_text(const std::vector<Token>& tokens, const Spellings& spellings, const Sources& sources,
                           const std::string& version, const TextPlace& version_place, bool layout, bool next_line);

}  // namespace kiln
