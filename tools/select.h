#pragma once
// "axis=value" words of the command line against a shader's axes.

#include <optional>
#include <string>
#include <vector>

#include "compiler/space/space.h"

namespace kiln {

// One digit per axis, or none where the command line said nothing.
using Selection = std::vector<std::optional<uint32_t>>;

// Names as in the manifest; a boolean axis also takes 0 and 1. A wrong name is an Error with the nearest right one.
Result<Selection> parse_selection(const std::vector<Axis>& axes, const std::vector<std::string>& words, size_t first);
// "light=point pass=depth", or "every variant".
std::string selection_text(const std::vector<Axis>& axes, const Selection& selection);
Set set_of(Diagram& diagram, const Selection& selection);

// The index of the shader called `name`; of the only one when `name` is empty.
Result<size_t> pick_shader(const std::vector<std::string>& shaders, const std::string& name);

}  // namespace kiln
