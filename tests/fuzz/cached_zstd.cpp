// Compressed bodies from arbitrary bytes: never more than the bound, and what was unpacked packs and unpacks to itself.
#include <cstdlib>

#include "cache/zstd.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    constexpr uint64_t most = 100'000;
    Bytes out;
    uint64_t asked = 0;
    const Unpacked how = zstd_unpack({data, size}, most, out, [&](uint64_t capacity) {
        asked = capacity;
        return true;
    });
    if (asked > most + 1 || out.size() > most + 1) std::abort();
    if (how != Unpacked::ok) return 0;
    if (out.size() > most) std::abort();
    Bytes again;
    if (zstd_unpack(zstd_compress(out, 1), most, again) != Unpacked::ok || again != out) std::abort();
    return 0;
}
