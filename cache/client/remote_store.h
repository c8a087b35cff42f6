#pragma once
// The seam to a cache server, whatever its protocol. A RemoteStore moves bytes and believes nothing, and neither does who
// calls it: what comes back is verified by the caller (layered_store.h), in one place for all protocols.
//
// Every call takes a batch and answers it in order, so that a protocol with batches uses them and one without keeps several
// requests under way. Calls block, end by their own deadlines, and may come from several threads.

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/digest.h"
#include "compiler/base/result.h"

namespace kiln {

struct RemoteBlob {
    static constexpr uint64_t unknown = ~uint64_t{0};
    Digest digest;
    uint64_t size = unknown;  // a protocol that needs it answers `absent` without it
};

struct RemoteAnswer {
    enum class Kind {
        found,   // read, is there, or was accepted
        absent,  // a miss; of a write: something else is there and stays
        denied,  // this token may not do that: asking again is useless
        failed,  // the server or the way to it
    };
    Kind kind = Kind::failed;
    Bytes bytes;          // of a get that found something: as they came
    std::string problem;  // denied or failed: for a person, without secrets
    bool waited = false;  // failed after a deadline's time, not at once
};

struct RemoteUpload {
    Digest key;
    ByteView bytes;
};

class RemoteStore {
public:
    virtual ~RemoteStore() = default;
    // For messages: scheme, host, port and path.
    virtual std::string name() const = 0;
    // Serialised ActionResults (remote_record.h).
    virtual std::vector<RemoteAnswer> get_actions(std::span<const Digest> keys) = 0;
    virtual std::vector<RemoteAnswer> get_blobs(std::span<const RemoteBlob> blobs) = 0;
    virtual std::vector<RemoteAnswer> find_blobs(std::span<const RemoteBlob> blobs) = 0;
    virtual std::vector<RemoteAnswer> put_blobs(std::span<const RemoteUpload> blobs) = 0;
    virtual std::vector<RemoteAnswer> put_actions(std::span<const RemoteUpload> actions) = 0;
    // From `when` on, calls under way and new ones end with `failed`.
    virtual void end_at(std::chrono::steady_clock::time_point when) = 0;
};

// What a server may make a client hold.
struct RemoteLimits {
    uint64_t action = uint64_t{1} << 20;
    uint64_t record = uint64_t{16} << 20;  // a record that is too large for its action, and is a blob
    uint64_t group = uint64_t{32} << 20;   // such records asked for at once, by the sizes told
    uint64_t held = uint64_t{128} << 20;   // such records of one call; those past it are misses
    uint64_t blob = uint64_t{256} << 20;
    uint64_t unknown_blob = uint64_t{64} << 20;  // of a size that nobody told
};

}  // namespace kiln
