#include "cache/client/remote_record.h"

#include <algorithm>
#include <string_view>

#include "cache/protocol/action_result.h"
#include "compiler/base/wire.h"

namespace kiln {

namespace {

constexpr std::string_view frame_magic = "kilnrec1";
constexpr std::string_view blob_path = "blob/", record_path = "record";

Bytes signed_part(const Digest& key, ByteView record) {
    WireWriter w;
    w.raw(as_bytes(frame_magic));
    w.raw(key.bytes);
    w.bytes(record);
    return w.take();
}

}  // namespace

Bytes write_frame(const Digest& key, ByteView record, const Signer* signer) {
    WireWriter w;
    const Bytes part = signed_part(key, record);
    w.raw(part);
    w.bytes(signer != nullptr ? signer->sign(part) : Bytes());
    return w.take();
}

Bytes write_action_value(ByteView frame, const std::vector<RemoteBlob>& blobs, const std::optional<RemoteBlob>& frame_blob) {
    ActionResult result;
    const auto name = [&](std::string path, const RemoteBlob& blob) {
        result.files.push_back({std::move(path), {blob.digest, blob.size}, false, {}});
    };
    for (const RemoteBlob& blob : blobs) name(std::string(blob_path) + blob.digest.hex(), blob);
    if (frame_blob)
        name(std::string(record_path), *frame_blob);
    else
        result.stdout_raw.assign(frame.begin(), frame.end());
    return serialise(result);
}

std::optional<ActionValue> read_action_value(ByteView bytes) {
    auto result = parse_action_result(bytes);
    if (!result.ok() || result->exit_code != 0 || result->files.size() > most_named_blobs) return std::nullopt;
    ActionValue value;
    if (!result->stdout_raw.empty()) value.frame = std::move(result->stdout_raw);
    bool elsewhere = false;
    for (const ActionResult::File& file : result->files) {
        const RemoteBlob blob{file.blob.digest, file.blob.size};
        if (file.path == record_path) {
            if (elsewhere) return std::nullopt;
            elsewhere = true;
            value.frame_blob = blob;
        } else if (file.path == std::string(blob_path) + blob.digest.hex()) {
            value.blobs.push_back(blob);
        } else {
            return std::nullopt;  // no path ever names a file here; one that is not the digest's own is not ours
        }
    }
    if (value.frame.has_value() == elsewhere) return std::nullopt;
    return value;
}

FrameCheck read_frame(const Digest& key, ByteView frame, const Verifier* trust, Bytes& record) {
    WireReader in(frame);
    const ByteView magic = in.raw(frame_magic.size());
    const ByteView for_key = in.raw(key.bytes.size());
    const ByteView payload = in.bytes();
    const ByteView signature = in.bytes();
    if (!in.ok() || !in.at_end() || as_text(magic) != frame_magic ||
        !std::equal(for_key.begin(), for_key.end(), key.bytes.begin()))
        return FrameCheck::damaged;
    if (trust != nullptr && !trust->verify(signed_part(key, payload), signature)) return FrameCheck::untrusted;
    record.assign(payload.begin(), payload.end());
    return FrameCheck::good;
}

}  // namespace kiln
