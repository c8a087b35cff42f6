// An action record of the disk store from arbitrary bytes: the first 32 are the key it is asked for. What is accepted must be
// exactly what writing its payload under that key gives.
#include "cache/disk_entry.h"

#include <cstdlib>
#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    Digest key;
    if (size < key.bytes.size()) return 0;
    std::memcpy(key.bytes.data(), data, key.bytes.size());
    const ByteView file(data + key.bytes.size(), size - key.bytes.size());
    const auto payload = action_payload(key, file);
    if (payload) {
        Bytes again = action_head(key, *payload);
        again.insert(again.end(), payload->begin(), payload->end());
        if (again.size() != file.size() || std::memcmp(again.data(), file.data(), file.size()) != 0) std::abort();
    }
    // And the other way: what is written is read back.
    const Bytes head = action_head(key, file);
    Bytes whole = head;
    whole.insert(whole.end(), file.begin(), file.end());
    const auto back = action_payload(key, whole);
    if (!back || back->size() != file.size() || (!file.empty() && std::memcmp(back->data(), file.data(), file.size()) != 0))
        std::abort();
    return 0;
}
