#pragma once
// Which entries there are, their sizes and when they were last used, so that the bound needs no walk over the folder. It only
// saves time: it is built from a scan, and where it is missing, damaged or not to be trusted it is built again.
//
//     index/data.mdb   LMDB: entry(space, key) -> size, used     order(used, space, key) -> nothing     totals
//     index/users      each process that has it open holds a shared lock
//     index/clean      the file's size and checksum, written by the last to close it, removed by the first to open it
//
// LMDB trusts what it maps, so a file is opened only when it is as the last user left it or when another user has it open.
// Whoever is killed as the last leaves no `clean`: the next one scans. Every call is made under the folder's lock, which
// replaces LMDB's own.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/base/store.h"

namespace kiln {

struct IndexEntry {
    Keyspace space = Keyspace::action;
    Digest key;
    uint64_t size = 0;
    int64_t used = 0;  // nanoseconds since 1970
};

struct IndexTotals {
    uint64_t entries = 0;
    uint64_t charged = 0;  // bytes in whole pages (disk_options.h)
    int64_t scanned = 0;   // when it was built from a scan
};

class DiskIndex {
public:
    // Changes happen together at commit(), or not at all.
    class Change {
    public:
        ~Change();
        Change(const Change&) = delete;
        Change& operator=(const Change&) = delete;
        Result<std::optional<IndexEntry>> find(Keyspace space, const Digest& key);
        Result<std::optional<IndexEntry>> oldest();
        Status put(const IndexEntry& entry);
        Status remove(Keyspace space, const Digest& key);
        const IndexTotals& totals() const { return totals_; }
        Status commit();

    private:
        friend class DiskIndex;
        explicit Change(DiskIndex& index) : index_(index) {}
        DiskIndex& index_;
        void* transaction_ = nullptr;
        IndexTotals totals_;
    };

    static Result<std::unique_ptr<DiskIndex>> open(const std::string& folder);
    ~DiskIndex();
    DiskIndex(const DiskIndex&) = delete;
    DiskIndex& operator=(const DiskIndex&) = delete;

    // False until rebuild() has succeeded once, by whichever process.
    bool built() const { return built_; }
    // False when the file under its name is another one or shorter than it was: this object must go.
    bool still_there() const;
    Status rebuild(const std::vector<IndexEntry>& entries, int64_t now);
    Result<std::unique_ptr<Change>> change();
    // Under the folder's lock: leaves `clean` when nobody else has the index open. Without it, the next user scans.
    void close();

    static void erase(const std::string& folder);

private:
    explicit DiskIndex(std::string folder) : folder_(std::move(folder)) {}
    Status start();
    Result<std::unique_ptr<Change>> begin();

    const std::string folder_;  // …/index
    int users_ = -1;
    void* environment_ = nullptr;
    unsigned entries_ = 0, order_ = 0;
    bool built_ = false;
    uint64_t inode_ = 0, length_ = 0;
};

}  // namespace kiln
