// The only file that includes xxHash.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "compiler/base/digest.h"

namespace kiln {

Fast xxh3(ByteView bytes) {
    const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
    return {h.low64, h.high64};
}

std::string Digest::hex() const {
    static constexpr char digits[] = "0123456789abcdef";
    std::string out;
    out.reserve(64);
    for (const uint8_t b : bytes) {
        out += digits[b >> 4];
        out += digits[b & 15];
    }
    return out;
}

std::optional<Digest> Digest::from_hex(std::string_view hex) {
    if (hex.size() != 64) return std::nullopt;
    Digest digest;
    for (size_t i = 0; i < 64; ++i) {
        const char c = hex[i];
        const int v = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
        if (v < 0) return std::nullopt;
        digest.bytes[i / 2] = static_cast<uint8_t>(digest.bytes[i / 2] << 4 | v);
    }
    return digest;
}

}  // namespace kiln
