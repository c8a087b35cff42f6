#include "cache/disk_entry.h"

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

}  // namespace kiln
