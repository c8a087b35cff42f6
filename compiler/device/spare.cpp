#include "compiler/device/spare.h"

#include <algorithm>

namespace kiln {

namespace {

constexpr uint32_t bad = 3;  // counted from 0

// The use before the first one that stands where none may, in one stage; uses.size() when there is none to move or to move it.
size_t before_bad(const std::vector<UniformUse>& uses, const std::vector<uint32_t>& spare, uint32_t stage) {
    uint32_t next = 0;
    size_t previous = uses.size();
    for (size_t i = 0; i < uses.size(); ++i) {
        if ((uses[i].stages & stage) == 0) continue;
        if (next <= bad && bad < next + uses[i].descriptors) return previous;
        next += uses[i].descriptors + spare[i];
        previous = i;
    }
    return uses.size();
}

uint32_t widest(const std::vector<UniformUse>& uses, const std::vector<uint32_t>& spare) {
    uint32_t out = 0;
    for (uint32_t stage = 1; stage != 0; stage <<= 1) {
        uint32_t sum = 0;
        for (size_t i = 0; i < uses.size(); ++i)
            if ((uses[i].stages & stage) != 0) sum += uses[i].descriptors + spare[i];
        out = std::max(out, sum);
    }
    return out;
}

}  // namespace

std::vector<uint32_t> spare_descriptors(const std::vector<UniformUse>& uses, uint32_t limit) {
    std::vector<uint32_t> spare(uses.size());
    // Every step moves a block on in some stage and none back.
    for (bool moved = true; moved;) {
        moved = false;
        for (uint32_t stage = 1; stage != 0; stage <<= 1)
            if (const size_t i = before_bad(uses, spare, stage); i < uses.size()) {
                ++spare[i];
                if (widest(uses, spare) > limit) return std::vector<uint32_t>(uses.size());
                moved = true;
            }
    }
    return spare;
}

}  // namespace kiln
