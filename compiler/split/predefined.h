#pragma once
// The macros that glslang 12 defines before the first line, for Vulkan GLSL.

#include <string_view>
#include <vector>

#include "compiler/manifest/stage.h"

namespace kiln {

struct Predefined {
    std::string_view name;
    int value = 1;
};

std::vector<Predefined> predefined_macros(Stage stage, int version, bool es, bool compatibility);

}  // namespace kiln
