#pragma once
// The few facts that a pipeline needs and reflection does not carry, read from a module's words. Tolerates any words.

#include <map>

#include "compiler/base/bytes.h"

namespace kiln {

struct ModuleFacts {
    uint32_t input_vertices = 3;                                               // of a geometry stage's primitive: 1, 2, 3, 4, 6
    uint32_t output_vertices = 0;                                              // of a tessellation control stage's patch
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> input_attachment_index;  // by (set, binding)
};

ModuleFacts facts_of(WordView words);

}  // namespace kiln
