#include "cache/disk_entry.h"

#include <algorithm>
#include <string_view>

#include "compiler/base/wire.h"

namespace kiln {

namespace {

constexpr std::string_view magic = "kilnact1";

Fast checksum(const Digest& key, ByteView payload) {
    const Fast body = xxh3(payload);
    WireWriter w;
    w.raw(key.bytes);
    w.u64(payload.size());
    w.u64(body.low);
    w.u64(body.high);
    return xxh3(w.view());
}

}  // namespace

Bytes action_head(const Digest& key, ByteView payload) {
    const Fast sum = checksum(key, payload);
    WireWriter w;
    w.raw(as_bytes(magic));
    w.raw(key.bytes);
    w.u64(payload.size());
    w.u64(sum.low);
    w.u64(sum.high);
    return w.take();
}

std::optional<ByteView> action_payload(const Digest& key, ByteView file) {
    if (file.size() < action_head_size) return std::nullopt;
    const ByteView payload = file.subspan(action_head_size);
    const Bytes expected = action_head(key, payload);
    const ByteView head = file.first(action_head_size);
    if (as_text(head) != as_text(expected)) return std::nullopt;
    return payload;
}

std::string entry_problem(Keyspace space, const Digest& key, ByteView file) {
    if (space == Keyspace::blob) {
        const Digest holds = sha256(file);
        if (holds == key) return {};
        return "its " + std::to_string(file.size()) + " bytes have the SHA-256 " + holds.hex();
    }
    if (action_payload(key, file)) return {};
    if (file.size() < action_head_size)
        return "a record of " + std::to_string(file.size()) + " bytes is shorter than its head of " +
               std::to_string(action_head_size);
    WireReader in(file);
    if (as_text(in.raw(magic.size())) != magic) return "it does not begin with " + std::string(magic);
    Digest named;
    const ByteView name = in.raw(named.bytes.size());
    std::copy(name.begin(), name.end(), named.bytes.begin());
    if (named != key) return "it is the record of " + named.hex();
    const uint64_t size = in.u64();
    if (size != file.size() - action_head_size)
        return "its head says " + std::to_string(size) + " bytes, it holds " + std::to_string(file.size() - action_head_size);
    return "its checksum does not match";
}

}  // namespace kiln
