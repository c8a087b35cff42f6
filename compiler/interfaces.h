#pragma once
// Checks that stages fit: outputs against inputs for every distinct pair of modules, resources that clash, blocks whose
// layout moves with an axis. Works on products of the stages' conditions, never on a list of variants.

#include "compiler/translate.h"

namespace kiln {

// A distinct tuple of stage modules that some needed variant uses.
struct Pipeline {
    uint32_t shader = 0;
    std::vector<uint32_t> modules;  // one per stage of the shader
    Set variants;
    Count count;
    Digits witness;  // its smallest variant
};

struct Interfaces {
    std::vector<Pipeline> pipelines;
    Diags diags;
};

Interfaces check_interfaces(const std::vector<StageClasses>& stages, const Modules& modules);

}  // namespace kiln
