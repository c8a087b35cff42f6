#pragma once
// The scene of a contact sheet: a sphere of radius 1 on a plane, a camera, one light, textures and shadow maps, worked out
// here and fitted to a shader's reflection by name. World space is right-handed with y up, in metres; clip space is Vulkan's.

#include "compiler/validate/device.h"

namespace kiln {

struct SheetScene {
    bool directional = false;  // the light is a sun; else it stands somewhere and is given in candela
    bool metal_map = false;    // filled in by scene_inputs(): some texture says what is metal
};

// The scene's inputs for these stages. What no name of the scene fits keeps its generated value (inputs.h).
Inputs scene_inputs(const std::vector<StageCode>& stages, const SheetScene& scene);

}  // namespace kiln
