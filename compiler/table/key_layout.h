#pragma once
// Where each axis of a shader has its digit in a key: one bit field an axis, in the axes' order, never across two words.

#include <cstdint>
#include <vector>

#include "compiler/manifest/axis.h"

namespace kiln {

struct KeyField {
    uint32_t word = 0, shift = 0, bits = 0;                              // bits = 0: one value only, the digit is always 0
    uint32_t packed() const { return word | shift << 16 | bits << 22; }  // `field` of runtime/table_format.h
};

struct KeyLayout {
    std::vector<KeyField> fields;  // one an axis
    std::vector<uint64_t> masks;   // one a word, at least one: the bits that some axis owns
};

KeyLayout key_layout(const std::vector<Axis>& axes);
std::vector<uint64_t> pack_key(const KeyLayout& layout, const Digits& digits);

}  // namespace kiln
