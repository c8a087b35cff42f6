#pragma once
// Where a pipeline's uniform blocks stand in lavapipe's tables. Mesa 22.3 (lvp_inline_uniforms.c) notes uniforms that decide a
// branch in a table of four a block, but steps from block to block by the number of blocks, 32. What it notes of the fourth block
// that a stage sees lands behind the table, in its counts, and a draw then crashes: where a shader of any size compares a
// uniform of that block with a value that is none. Later blocks land in what is never read.
//
// So no block stands fourth: the one before it gets a descriptor more than the shader has, bound to the same buffer, which
// Vulkan allows and no shader reads.

#include <cstdint>
#include <vector>

namespace kiln {

struct UniformUse {
    uint32_t descriptors = 1;
    uint32_t stages = 0;  // bits
};

// How many descriptors more each needs. uses: by set and binding, the order in which a driver counts; limit: of descriptors
// a stage, past which nothing is added. A first block that is an array of four or more stays as it is.
std::vector<uint32_t> spare_descriptors(const std::vector<UniformUse>& uses, uint32_t limit);

}  // namespace kiln
