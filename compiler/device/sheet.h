#pragma once
// A contact sheet: a lit sphere on a plane, drawn once with each of some variants of one shader, labelled, as one PNG.
//
// The scene is fitted to the shader *by name*, from the table's reflection: matrices, camera, light, material and texture names
// that it knows get the scene's values (sheet_scene.cpp lists them), unknown members get the generated ordinary ones. Outputs
// are shown by what they hold: output 0 tone-mapped and sRGB-encoded where it is lit colour; several outputs (a G-buffer) side
// by side; a depth-only variant as depth; two signed components (motion vectors) around grey.

#include <string>
#include <vector>

#include "compiler/toolchain/toolchain.h"
#include "compiler/validate/device.h"

namespace kiln {

struct SheetOptions {
    std::string shader;                 // empty: the first
    std::vector<std::string> variants;  // "axis=value axis=value", axes may be left out; empty: chosen by spreading over axes
    uint32_t count = 48;                // when chosen
    uint32_t tile = 192;                // pixels
};

struct Sheet {
    Bytes png;
    std::string summary;  // one line a tile: variant, pixels drawn, mean colour
    uint32_t tiles = 0;
    uint32_t undrawn = 0, failed = 0;
};

// Input errors: a damaged table, an unknown shader, axis or value, a variant that is not in the table.
Result<Sheet> render_sheet(ByteView table, const SheetOptions& options, Device& device, Toolchain& tools);

}  // namespace kiln
