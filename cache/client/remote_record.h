#pragma once
// How an action record travels: as a REAPI ActionResult, so that any server of that protocol can hold it and check that the
// blobs it names are there.
//
//     ActionResult   exit_code 0
//       output_files  path "blob/<sha256>", digest    each blob that the record needs
//       stdout_raw    the frame, when it is small; else
//       output_files  path "record", digest           the blob that is the frame
//     frame = "kilnrec1"  key:32  record:(u64 size, bytes)  signature:(u64 size, bytes)      little-endian
//
// The key inside makes an answer to another question a miss. Nothing else here says that the record is true: whoever may
// write the server can write a well-formed record that names a wrong, but whole, module. The signature says who wrote it.

#include <optional>
#include <vector>

#include "cache/client/remote_store.h"
#include "cache/client/signature.h"

namespace kiln {

struct RemoteRecord {
    Bytes record;
    std::vector<RemoteBlob> blobs;
};

// Both halves of the way in: the ActionResult may hold the frame or name its blob.
struct ActionValue {
    std::optional<Bytes> frame;
    RemoteBlob frame_blob;  // when there is no frame
    std::vector<RemoteBlob> blobs;
};

constexpr size_t most_inline_frame = 128 * 1024;
constexpr size_t most_named_blobs = 4096;

Bytes write_frame(const Digest& key, ByteView record, const Signer* signer);
// The bytes of an ActionResult; `frame_blob` is where the frame lies when it is not in it.
Bytes write_action_value(ByteView frame, const std::vector<RemoteBlob>& blobs, const std::optional<RemoteBlob>& frame_blob);

// nullopt for anything but an ActionResult that kiln could have written; what servers add to one is skipped.
std::optional<ActionValue> read_action_value(ByteView bytes);

enum class FrameCheck { good, damaged, untrusted };
// `record` is set when good. With `trust`, a frame without a signature that it verifies is untrusted.
FrameCheck read_frame(const Digest& key, ByteView frame, const Verifier* trust, Bytes& record);

}  // namespace kiln
