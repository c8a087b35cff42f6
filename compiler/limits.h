#pragma once
// What a target cannot say although SPIRV-Cross would write something: found in the module's instructions, not in the text.

#include <string>

#include "compiler/module_resources.h"
#include "compiler/stage.h"

namespace kiln {

// Why `target` cannot say this module; empty when nothing is known against it.
std::string target_limit(const ir::View& view, const Reflected& reflected, Target target);

}  // namespace kiln
