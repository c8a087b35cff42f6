#pragma once
// Keeps a store's folder under its bound. An entry is admitted before it gets its name, so that what has a name never adds
// up to more than the bound; when it would, the least recently used go until the low watermark is reached.
//
// When an entry was last used is its file's time stamp, which readers set. The index only orders: a row that is out of date
// is put right when its turn comes.

#include <memory>
#include <string>
#include <vector>

#include "cache/disk_index.h"
#include "cache/disk_options.h"

namespace kiln {

struct DiskUse {  // what a part of a store holds
    uint64_t entries = 0;
    uint64_t bytes = 0;    // of file contents
    uint64_t charged = 0;  // in whole pages; what the bound is about
    void add(uint64_t size) {
        ++entries;
        bytes += size;
        charged += charge_of(size);
    }
};

// Every call is made under the folder's lock.
class DiskBound {
public:
    // `options` outlives this object.
    DiskBound(std::string folder, const DiskOptions& options) : folder_(std::move(folder)), options_(options) {}

    // Makes room for an entry and counts it. `alone`: other processes are kept out by the lock; only then is the index used.
    Status admit(Keyspace space, const Digest& key, uint64_t size, bool alone);
    void forget(Keyspace space, const Digest& key, bool alone);

    struct Shrunk {
        DiskUse before, evicted;
    };
    // Scans, evicts the oldest until at most `target` is charged, and builds the index again.
    Result<Shrunk> shrink(uint64_t target, bool alone);
    bool has_index() const { return index_ != nullptr; }
    void close();  // the index
    void reset();  // forgets all; nothing is in the folder any more

    uint64_t evicted() const { return evicted_; }

private:
    struct Found {
        std::vector<IndexEntry> entries;
        DiskUse use;
    };
    Result<Found> scan() const;
    Status evict_from(Found& found, uint64_t target, DiskUse& evicted);
    Status ready_index();
    Status admit_by_index(const IndexEntry& entry);
    Status admit_by_scan(const IndexEntry& entry);
    Status make_room(DiskIndex::Change& change, uint64_t target);
    int remove(const std::string& path);
    std::string path_of(const IndexEntry& entry) const;
    int64_t now() const;
    bool index_wanted(bool alone);
    void drop_index();

    const std::string folder_;
    const DiskOptions& options_;
    std::unique_ptr<DiskIndex> index_;
    bool index_off_ = false, looked_ = false;
    // Without an index: what the last scan found and what this process has added since.
    bool scanned_ = false;
    uint64_t estimate_ = 0, since_scan_ = 0;
    uint64_t evicted_ = 0;
};

}  // namespace kiln
