#pragma once
// What a writer of expressions will meet more than once.

#include <vector>

#include "compiler/base/bytes.h"

namespace kiln {

// The results that SPIRV-Cross will have to name, since their text would otherwise stand in two places, or in a loop, or behind
// a branch that their derivatives do not survive. A guess, made of the words alone: one too few costs a second round, one too
// many a name that was not needed; neither changes what the text means.
struct ReadOften {
    std::vector<uint32_t> ids;
    std::vector<uint32_t> by_component;  // these too, in targets that compare vectors component by component
};

// Nothing for modules with instructions that read_operands() does not know.
ReadOften find_read_often(WordView words);

}  // namespace kiln
