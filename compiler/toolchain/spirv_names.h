#pragma once
// Which names of a module belong to its interface.

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

// Drops every OpName and OpMemberName but those of interface variables (inputs, outputs, resources, push constants, ray
// payloads), of the structures that their types contain, and of specialisation constants; also drops source text, lines and
// strings nobody else refers to. An error when the words are not well-formed SPIR-V instructions.
Result<Words> keep_interface_names(WordView words);

// Whether the source enabled GL_EXT_scalar_block_layout; keep_interface_names() leaves that trace.
bool wants_scalar_layout(WordView words);

}  // namespace kiln
