#pragma once
// Compresses images for the GPU to BC1, BC7 and unsigned BC6H. The encoder is Basis Universal, run in a process of its own by
// encode_bc.mjs (Node); nothing else of kiln needs it.

#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

enum class BcFormat { bc1, bc7, bc6h };

// 8 for bc1, else 16: bytes of a block of 4 x 4 texels.
uint32_t bc_block_bytes(BcFormat format);

// Linear RGBA, row after row from the top. bc1 and bc6h hold no alpha.
struct FloatImage {
    uint32_t width = 0, height = 0;
    std::vector<float> rgba;
};

struct BcImage {
    BcFormat format = BcFormat::bc1;
    uint32_t width = 0, height = 0;     // of the image, not of the padded one
    Bytes blocks;                       // row after row; edges are padded with the last texel
    std::vector<std::string> warnings;  // what was put right before encoding, each naming the image and its first such texel
};

// What a format cannot hold is put right, once and with a warning: not a number and negative values become 0, infinities
// and values above the largest (1; for bc6h 65504) become the largest. Returns the warnings; `name` is how they call the image.
std::vector<std::string> sanitise(FloatImage& image, BcFormat format, const std::string& name);

// Refuses (Fault::input) a size of zero or above 16384, or texels that do not fit the size; Fault::environment when Node or
// the encoder's package is missing. `scripts`: the folder that holds encode_bc.mjs and its node_modules.
Result<BcImage> encode_bc(BcFormat format, FloatImage image, const std::string& name, const std::string& scripts);

}  // namespace kiln
