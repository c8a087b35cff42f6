#pragma once
// zstd with bounds, for the wire. What a stranger sent can neither claim nor expand to more than the caller allows.

#include <functional>

#include "compiler/base/bytes.h"

namespace kiln {

Bytes zstd_compress(ByteView bytes, int level);

enum class Unpacked {
    ok,
    damaged,    // not zstd, cut short, or with something behind its end
    too_large,  // more than `most` bytes, or a window of more than 8 MiB
    no_room,    // `grow` said no
};

// Appends to `out`. Never holds more than `most` bytes, and a frame that announces more is refused before it is decoded.
// `grow(capacity)` is asked before out's capacity grows; empty: always yes.
Unpacked zstd_unpack(ByteView bytes, uint64_t most, Bytes& out, const std::function<bool(uint64_t)>& grow = {});

}  // namespace kiln
