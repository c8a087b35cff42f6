#pragma once
// A content-addressed store in a folder. Any number of threads and processes may share it without locks: an entry is
// written under a temporary name and renamed, so that a reader finds a whole entry or none.
//
//     action/ab/abcdef…   a framed record (disk_entry.h)          blob/ab/abcdef…   the bytes that hash to that name
//     tmp/…               being written; swept on open once an hour old
//
// Every read is verified: an entry that is truncated, altered or under a foreign name is removed, counted and treated as
// absent. For that reason nothing is flushed to disk: after a power cut an entry may be short, which is a miss. A full or
// read-only disk makes put() an Error and loses nothing that was there.

#include <atomic>
#include <memory>
#include <string>

#include "compiler/base/store.h"

namespace kiln {

// $XDG_CACHE_HOME/kiln, else ~/.cache/kiln; empty when neither variable holds an absolute path.
std::string default_cache_folder();

class DiskStore final : public Store {
public:
    struct Use {  // what a keyspace holds on disk
        uint64_t entries = 0;
        uint64_t bytes = 0;  // of file contents
    };
    struct Stats {
        Use action, blob, temporary;
    };
    struct Counters {  // since this store was opened
        uint64_t hits = 0, misses = 0;
        uint64_t corrupt = 0;  // entries found damaged; also counted as misses
        uint64_t written = 0, already_there = 0;
        uint64_t failures = 0;  // get or put that returned an Error
    };

    // Creates the folder where it is missing. A folder that exists and cannot be written still serves reads.
    static Result<std::unique_ptr<DiskStore>> open(const std::string& folder);

    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override;
    // A blob that is there with the same size is not written again; an action record is replaced.
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;

    // Walks the folder. Files that this store would not have written are neither counted nor removed.
    Result<Stats> stats() const;
    // Removes every entry and temporary file, also those of other processes, whose next put makes its folders again.
    // Returns what was removed; an Error when something could not be.
    Result<Stats> clear();
    Counters counters() const;
    const std::string& folder() const { return folder_; }

private:
    explicit DiskStore(std::string folder) : folder_(std::move(folder)) {}
    std::string entry_path(Keyspace space, const Digest& key) const;
    Result<std::optional<Bytes>> load(Keyspace space, const Digest& key);
    Status publish(const std::string& path, ByteView head, ByteView body);
    void sweep_temporaries() const;

    std::string folder_;  // absolute
    std::atomic<uint64_t> hits_{0}, misses_{0}, corrupt_{0}, written_{0}, already_there_{0}, failures_{0};
};

}  // namespace kiln
