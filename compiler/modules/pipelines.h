#pragma once
// The distinct tuples of stage modules that needed variants use, from the product of the stages' conditions.

#include <vector>

#include "compiler/modules/modules.h"

namespace kiln {

// A distinct tuple of stage modules that some needed variant uses.
struct Pipeline {
    uint32_t shader = 0;
    std::vector<uint32_t> modules;  // one per stage of the shader
    Set variants;
    Count count;
    Digits witness;  // its smallest variant
};

// One shader's part of a build. Shaders are numbered by first appearance in the stages.
struct ShaderStages {
    const Shader* shader = nullptr;
    Space* space = nullptr;
    std::vector<size_t> stages;  // indices, ascending by Stage as in the manifest
    // One per stage: the modules in order of first use with the variants that have each. They partition what was split.
    std::vector<std::vector<std::pair<uint32_t, Set>>> modules;
};

std::vector<ShaderStages> shader_stages(const std::vector<StageClasses>& stages, const Modules& modules);

// Ordered by shader, then by smallest variant. The variants of one shader's pipelines are disjoint.
std::vector<Pipeline> find_pipelines(const std::vector<ShaderStages>& shaders);

}  // namespace kiln
