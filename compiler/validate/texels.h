#pragma once
// Sizes of encoded texels, for whoever fills an ImageData.

#include "compiler/validate/device.h"

namespace kiln {

// What a format stores at once: a texel, or a block of side x side texels.
struct TexelBlock {
    uint32_t side = 1, bytes = 16;
};
TexelBlock block_of(TexelFormat format, bool depth = false);  // `depth` tells the two meanings of `standard` apart

const char* name_of(TexelFormat format);  // "bc7_unorm"

// Bytes of one mip, all layers and slices of it; and of all mips.
size_t mip_bytes(const ImageData& image, uint32_t mip);
size_t image_bytes(const ImageData& image);

}  // namespace kiln
