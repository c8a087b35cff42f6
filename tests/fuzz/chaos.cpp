// The text of --chaos from arbitrary bytes: refused, or chances and delays within their ranges.
#include <cstdlib>

#include "cache/chaos_store.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const auto chaos = Chaos::parse({reinterpret_cast<const char*>(data), size});
    if (!chaos.ok()) return 0;
    for (const double chance : {chaos->loss, chaos->error, chaos->flip})
        if (!(chance >= 0 && chance <= 1)) std::abort();
    if (chaos->delay > 60'000) std::abort();
    return 0;
}
