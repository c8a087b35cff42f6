#pragma once
// A content-addressed store in a folder, shared by any number of threads and processes of a machine.
//
//     action/ab/abcdef…   a framed record (disk_entry.h)          blob/ab/abcdef…   the bytes that hash to that name
//     tmp/…               being written; swept on open once an hour old
//     quarantine/…        found damaged; at most `most_quarantined` are kept, as evidence
//     index/…             saves scans (disk_index.h); may be removed while no kiln runs
//     lock                held while an entry is counted and named (disk_lock.h)
//
// put() writes a temporary file, flushes it (Sync), counts it against the bound and renames it. When it has returned without
// an Error, every process finds the whole entry until it is evicted or removed, whoever is killed; what a power cut leaves
// is said at Sync. Nothing half-written ever has an entry's name.
//
// Every read is verified: an entry that is truncated, altered or under a foreign name is quarantined, counted and treated as
// absent. A disk that is full, read-only or slow makes put() an Error and loses nothing that was there.

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cache/disk_bound.h"
#include "cache/disk_folder.h"
#include "cache/disk_lock.h"
#include "cache/disk_options.h"
#include "compiler/base/store.h"

namespace kiln {

// Bytes that were found to hash to their name, for a store that need not hash them again. They outlive it and do not change.
class HashedBlob {
public:
    // nullopt: they do not.
    static std::optional<HashedBlob> of(const Digest& name, ByteView bytes) {
        if (sha256(bytes) != name) return std::nullopt;
        return HashedBlob(name, bytes);
    }
    const Digest& name() const { return name_; }
    ByteView bytes() const { return bytes_; }

private:
    HashedBlob(const Digest& name, ByteView bytes) : name_(name), bytes_(bytes) {}
    Digest name_;
    ByteView bytes_;
};

// $XDG_CACHE_HOME/kiln, else ~/.cache/kiln; empty when neither variable holds an absolute path.
std::string default_cache_folder();

// Not carried over a fork: a child opens its own.
class DiskStore final : public Store {
public:
    static constexpr size_t most_quarantined = 128;

    struct Stats {
        DiskUse action, blob, temporary, quarantine;
        DiskUse entries() const {
            return {action.entries + blob.entries, action.bytes + blob.bytes, action.charged + blob.charged};
        }
    };
    struct Counters {  // since this store was opened
        uint64_t hits = 0, misses = 0;
        uint64_t corrupt = 0;  // entries found damaged; also counted as misses
        uint64_t written = 0, already_there = 0;
        uint64_t evicted = 0;
        uint64_t failures = 0;  // get or put that returned an Error
    };
    struct Damage {
        std::string path, reason;
        std::string kept;  // where it lies now; empty when it could not be moved
    };
    struct Verified {
        DiskUse checked;
        std::vector<Damage> damaged;
        std::vector<Damage> unreadable;  // neither whole nor damaged: the disk or its permissions stood in the way
    };
    using Shrunk = DiskBound::Shrunk;

    // Called, on the thread that found it, for an entry that get() or put() met damaged. Set before the first of them.
    std::function<void(const Damage&)> on_damage;

    // Creates the folder where it is missing. A folder that exists and cannot be written still serves reads.
    static Result<std::unique_ptr<DiskStore>> open(const std::string& folder, DiskOptions options = {});
    ~DiskStore() override;

    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override;
    // What is there with the same bytes is not written again; an action record with others is replaced.
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;
    Status put(const HashedBlob& blob) { return keep(Keyspace::blob, blob.name(), blob.bytes()); }
    // The size of an entry that is there, which counts as a use of it. Its bytes are not verified.
    Result<std::optional<uint64_t>> find(Keyspace space, const Digest& key);

    // Walks the folder. Files that this store would not have written are neither counted nor removed.
    Result<Stats> stats() const;
    // Reads every entry and quarantines what is damaged.
    Result<Verified> verify();
    // Evicts the least recently used until at most `target` bytes are charged, and removes old temporary files.
    Result<Shrunk> gc(uint64_t target);
    // Removes every entry, temporary and quarantined file, also those of other processes, whose next put makes its folders
    // again. Returns what was removed; an Error when something could not be.
    Result<Stats> clear();
    Counters counters() const;
    const std::string& folder() const { return folder_; }
    const DiskOptions& options() const { return options_; }
    std::string path_of(Keyspace space, const Digest& key) const { return entry_path(folder_, space, key); }

private:
    struct Reading;
    DiskStore(std::string folder, DiskOptions options);
    Reading read(Keyspace space, const Digest& key, bool use) const;
    Status keep(Keyspace space, const Digest& key, ByteView bytes);
    Result<std::optional<Bytes>> load(Keyspace space, const Digest& key);
    Reading set_aside(Keyspace space, const Digest& key, std::string& kept);
    Reading mended(Keyspace space, const Digest& key);
    void trim_quarantine() const;
    Status publish(Keyspace space, const Digest& key, ByteView head, ByteView body);
    Status flush_names(Keyspace space, const Digest& key, bool new_shard);
    Status name_draft(Keyspace space, const Digest& key, const std::string& draft, uint64_t size);
    void sweep_temporaries() const;
    int64_t now() const;
    int step(DiskStep which) const { return options_.before ? options_.before(which) : 0; }

    const std::string folder_;  // absolute
    const DiskOptions options_;
    FolderLock lock_;
    DiskBound bound_;
    // By keyspace and first byte: shards whose own names this process has flushed, whoever made them.
    std::array<std::atomic<bool>, 512> shard_flushed_{};
    std::atomic<uint64_t> hits_{0}, misses_{0}, corrupt_{0}, written_{0}, already_there_{0}, evicted_{0}, failures_{0};
};

}  // namespace kiln
