// The mark of a closed index from arbitrary bytes: what is accepted must be exactly what writing it gives.
#include "cache/disk_clean.h"

#include <cstdlib>
#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const auto mark = read_mark({data, size});
    if (mark) {
        const Bytes again = write_mark(*mark);
        if (again.size() != size || std::memcmp(again.data(), data, size) != 0) std::abort();
    }
    CleanMark made;
    if (size != 0) std::memcpy(&made, data, size < sizeof made ? size : sizeof made);
    const auto back = read_mark(write_mark(made));
    if (!back || !(*back == made)) std::abort();
    return 0;
}
