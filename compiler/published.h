#pragma once
// What a table publishes, through the reader that a game links, in the compiler's own types.

#include "compiler/axis.h"
#include "compiler/base/result.h"
#include "compiler/device.h"
#include "compiler/runtime/kiln.h"

namespace kiln {

std::string text_of(kiln_text text);

// The shader's axes; places are empty.
std::vector<Axis> published_axes(const kiln_shader& shader);

// One module of a shader as a pipeline needs it: its words in place copied, its reflection with every resource at the number
// of its *slot*, since that is what an engine binds by. An input Error when the table is damaged or a resource has no slot.
Result<StageCode> published_stage(const kiln_table& table, const kiln_shader& shader, uint32_t module);

// "light=point pass=forward", axes in order.
std::string published_variant(const kiln_shader& shader, const uint64_t* key);

}  // namespace kiln
