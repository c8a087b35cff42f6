#pragma once
// SPIRV-Cross, and what it needs around it, in our own types. Every function may be called from several threads at once.

#include <string>
#include <vector>

#include "compiler/toolchain/toolchain.h"

namespace kiln {

std::string cross_version();  // "SPIRV-Cross C API 0.54.0"

// One valid module (spirv-val) into several targets, parsed once; results in the order of `targets`, and a refusal for
// `spirv`. Never invalid text on purpose: what a target is known not to say (compiler/toolchain/limits.h), what SPIRV-Cross
// throws on, and a resource that `slots` does not have are refusals with a reason. The same input always gives the same text.
//
// Numbers come from `slots` (compiler/translate/translate.h says which); names of blocks, images and samplers are the slots'
// names. GLSL and ESSL texts convert depth from Vulkan's 0..1 to -1..1 at the end of the vertex stage; no target flips y.
std::vector<Translated> cross_translate(WordView words, const std::vector<Target>& targets, const SlotLayout& slots);

}  // namespace kiln
