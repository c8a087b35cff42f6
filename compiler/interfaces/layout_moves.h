#pragma once
// What changes about a shader's resources from variant to variant, over all of its stages.

#include "compiler/modules/pipelines.h"

namespace kiln {

// Adds, each with its conditions:
//   - an error where variants use one set and binding for different kinds of resource: no one layout holds both;
//   - a warning where only the image's type or the name differs;
//   - a warning where members of a block move or change with an axis, naming the axes: variants then share neither modules
//     nor one layout on the CPU. A member that only some variants have moves nothing by itself.
void report_layouts(const ShaderStages& shader, const std::vector<StageClasses>& stages, const Modules& modules, Diags& diags);

}  // namespace kiln
