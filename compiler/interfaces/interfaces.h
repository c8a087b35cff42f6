#pragma once
// Checks that stages fit: outputs against inputs for every distinct pair of modules, resources that clash, blocks whose
// layout moves with an axis. Works on products of the stages' conditions, never on a list of variants.

#include "compiler/modules/pipelines.h"
#include "compiler/translate/translate.h"

namespace kiln {

struct Interfaces {
    std::vector<Pipeline> pipelines;
    Diags diags;
};

Interfaces check_interfaces(const std::vector<StageClasses>& stages, const Modules& modules);

}  // namespace kiln
