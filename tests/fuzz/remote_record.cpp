// Everything that a server's answer to an action goes through.
#include <cstdlib>

#include "cache/client/remote_record.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const ByteView bytes(data, size);
    const Digest key = sha256(as_bytes(std::string_view("key")));
    Bytes record;
    if (const auto value = read_action_value(bytes)) {
        if (value->blobs.size() > most_named_blobs) std::abort();
        if (value->frame && read_frame(key, *value->frame, nullptr, record) == FrameCheck::good) {
            // What is good is exactly what kiln writes, but for the signature.
            const Bytes again = write_frame(key, record, nullptr);
            if (again.size() > value->frame->size()) std::abort();
        }
    }
    if (read_frame(key, bytes, nullptr, record) == FrameCheck::good && record.size() > size) std::abort();
    return 0;
}
