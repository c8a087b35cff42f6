// A ByteStream resource name from arbitrary bytes: what is accepted is what its parts write.
#include "cache/protocol/resource_name.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const auto name = parse_resource_name(as_text({data, size}));
    if (!name || name->zstd) return 0;
    const std::string again = name->upload ? upload_name(name->instance, "u", name->blob) : read_name(name->instance, name->blob);
    if (parse_resource_name(again) != name) std::abort();
    return 0;
}
