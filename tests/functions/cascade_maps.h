#pragma once
// Cascaded shadow maps for the tests of functions: four layers of blocks.

#include "tests/functions/shadow_maps.h"
#include "uber/reference/cascades.h"
#include "uber/reference/pcf.h"

namespace kiln::test {

// Four layers of random blocks of 4 x 4 texels.
inline DepthTexture blocks(int size) {
    DepthTexture out{size, {}};
    for (int layer = 0; layer < 4; ++layer)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                out.depths.push_back(static_cast<float>(
                    reference::pixel_hash(static_cast<uint32_t>(x / 4 + 64 * layer), static_cast<uint32_t>(y / 4))));
    return out;
}

}  // namespace kiln::test
