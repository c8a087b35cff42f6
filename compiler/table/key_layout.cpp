#include "compiler/table/key_layout.h"

#include <bit>

namespace kiln {

KeyLayout key_layout(const std::vector<Axis>& axes) {
    KeyLayout out;
    out.masks.push_back(0);
    uint32_t used = 0;
    for (const Axis& axis : axes) {
        const uint64_t most = axis.values.empty() ? 0 : axis.values.size() - 1;
        const auto bits = static_cast<uint32_t>(std::bit_width(most));
        if (used + bits > 64) {
            out.masks.push_back(0);
            used = 0;
        }
        // A field without bits at the end of a full word is put at its start: shifts stay below 64.
        const uint32_t shift = bits == 0 ? 0 : used;
        out.fields.push_back({static_cast<uint32_t>(out.masks.size() - 1), shift, bits});
        out.masks.back() |= ((uint64_t{1} << bits) - 1) << shift;
        used += bits;
    }
    return out;
}

std::vector<uint64_t> pack_key(const KeyLayout& layout, const Digits& digits) {
    std::vector<uint64_t> key(layout.masks.size());
    for (size_t i = 0; i < digits.size(); ++i)
        key[layout.fields[i].word] |= static_cast<uint64_t>(digits[i]) << layout.fields[i].shift;
    return key;
}

}  // namespace kiln
