#pragma once
// --parse-back: glslang reads every distinct GLSL and ESSL text again, and joins every (vertex, fragment) pair of texts that
// some pipeline uses. What it does not accept is an error with the variants that it hits. Answers are kept in the store.

#include "compiler/modules/pipelines.h"
#include "compiler/translate/translate.h"

namespace kiln {

struct ParseBackContext {
    const std::vector<StageClasses>& stages;
    const Modules& modules;
    const std::vector<Target>& targets;
    Store& store;
    Toolchain& tools;
    const Jobs& jobs;
    const Progress& progress;
};

// Adds to artifacts.diags.
void parse_texts_back(const ParseBackContext& context, const std::vector<ShaderStages>& shaders, Artifacts& artifacts);

}  // namespace kiln
