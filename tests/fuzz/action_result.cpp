// An ActionResult and a Tree from arbitrary bytes: what is accepted reads back the same from what serialise() makes of it.
#include "cache/protocol/action_result.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    (void)parse_tree_files({data, size});
    const auto result = parse_action_result({data, size});
    if (!result.ok()) return 0;
    const Bytes again = serialise(*result);
    const auto back = parse_action_result(again);
    if (!back.ok() || *back != *result || serialise(*back) != again) std::abort();
    return 0;
}
