#pragma once
// A blob open for reading. It stays readable when the store evicts it meanwhile.

#include <mutex>
#include <optional>
#include <unordered_map>

#include "cache/disk_folder.h"
#include "cache/disk_store.h"

namespace kiln {

class BlobFile {
public:
    BlobFile() = default;  // the empty blob
    static BlobFile of(Bytes bytes);
    uint64_t size() const { return size_; }
    // Fills `out` from `offset` on; an Error when the file has become shorter or the disk fails.
    Status read(uint64_t offset, std::span<uint8_t> out) const;
    // The bytes where they are in memory already; empty for a blob that is read from its file.
    ByteView memory() const { return memory_ ? ByteView(*memory_) : ByteView(); }
    // The same, for whoever keeps them longer than this object; null where memory() is empty.
    const std::shared_ptr<const Bytes>& shared_memory() const { return memory_; }
    // The open file of one that is not in memory, for sendfile(2); -1.
    int descriptor() const { return fd_ ? fd_->get() : -1; }
    // The whole of it.
    Result<Bytes> all() const;

private:
    friend class BlobReader;
    std::shared_ptr<const Descriptor> fd_;  // null: all bytes are in memory_
    std::shared_ptr<const Bytes> memory_;   // small ones, from the read that verified them
    uint64_t size_ = 0;
};

// Opens blobs of a DiskStore and verifies them. A file is hashed when it is first read and again when anything about it has
// changed (inode, size, modification, change of status) or `again_after` has passed; between, its bytes are trusted. The
// kernel sets a file's change time at every write and nobody can set it back, so an altered file is hashed again; bytes that
// rot on the disk below the file system are found at the next hashing, and by every client that checks its digest.
//
// Small blobs that are read again are kept in memory, at most `most_kept` bytes of them; such a read looks at the file's
// identity and no further.
//
// Whatever does not match goes to the store, which reads it once more, quarantines it and answers "absent".
class BlobReader {
public:
    // `again_after` in seconds; 0: hash at every read.
    BlobReader(DiskStore& store, int64_t again_after) : store_(store), again_after_(again_after) {}
    static constexpr uint64_t moment = uint64_t{1} << 20;  // hashed in less than a millisecond
    // With `slow`: sets it instead of hashing a file of more than `most` bytes, and answers nothing.
    Result<std::optional<BlobFile>> open(const Digest& key, bool* slow = nullptr, uint64_t most = moment);
    // Whether a blob of this size is there; counts as a use. Its bytes are not verified.
    Result<bool> has(const Digest& key, uint64_t size);
    uint64_t hashed() const { return hashed_; }
    uint64_t kept() const;  // bytes
    static constexpr uint64_t most_kept = 16 << 20;

private:
    static constexpr size_t shards = 16, most_in_shard = 4096;
    static constexpr uint64_t small = 32 * 1024;  // read whole; beyond, sendfile is steadier
    struct Identity {
        uint64_t device = 0, inode = 0, size = 0;
        int64_t modified = 0, changed = 0;
        friend bool operator==(const Identity&, const Identity&) = default;
    };
    struct Verified {
        Identity identity;
        int64_t at = 0;                      // nanoseconds since 1970
        std::shared_ptr<const Bytes> bytes;  // null: not kept
    };
    struct Shard {
        mutable std::mutex mutex;
        uint64_t kept = 0;
        size_t hand = 0;  // the bucket whose bytes went last
        std::unordered_map<Digest, Verified> known;
    };
    static Identity identity_of(const struct stat& info);
    bool fresh(const Verified& verified, int64_t now) const;
    bool trusted(const Digest& key, const Identity& identity, int64_t now);
    void keep(const Digest& key, const std::shared_ptr<const Bytes>& bytes);
    std::shared_ptr<const Bytes> kept_bytes(const Digest& key, const std::string& path);
    void trust(const Digest& key, const Identity& identity, int64_t now);
    Shard& shard_of(const Digest& key) { return shards_[key.bytes[31] % shards]; }
    const Shard& shard_of(const Digest& key) const { return shards_[key.bytes[31] % shards]; }

    DiskStore& store_;
    const int64_t again_after_;
    std::array<Shard, shards> shards_;
    std::atomic<uint64_t> hashed_{0};
};

}  // namespace kiln
