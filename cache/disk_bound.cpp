// Two ways to know what is there. The index, a row an entry, is changed in the transaction that admits an entry, before the
// entry is named: a process killed between the two leaves a row too many, never one too few, so the sum errs on the safe
// side and eviction finds the missing file. Where no index can be kept (a network file system, a full disk, damage), the
// folder is scanned, at the first write and then after each sixteenth of the bound; several processes together may pass the
// bound by that much each.
#include "cache/disk_bound.h"

#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <limits>
#include <tuple>

#include "cache/disk_folder.h"

namespace kiln {

namespace {

constexpr int64_t scan_at_least_every = int64_t{86'400} * 1'000'000'000;
constexpr size_t most_stuck = 64;  // entries that cannot be removed, before eviction gives up

// LMDB maps its file, which works among the processes of one machine only.
bool on_this_machine(const std::string& folder) {
    struct statfs info {};
    if (::statfs(folder.c_str(), &info) != 0) return false;
    // NFS, SMB, SMB2, CIFS, FUSE, 9P, AFS, Ceph, Lustre, GFS2, OCFS2
    constexpr uint32_t shared[] = {0x6969,     0x517b,     0xfe534d42, 0xff534d42, 0x65735546, 0x01021997,
                                   0x5346414f, 0x00c36400, 0x0bd00bd0, 0x01161970, 0x7461636f};
    return std::find(std::begin(shared), std::end(shared), static_cast<uint32_t>(info.f_type)) == std::end(shared);
}

}  // namespace

int64_t DiskBound::now() const { return options_.now ? options_.now() : system_time(); }

std::string DiskBound::path_of(const IndexEntry& entry) const { return entry_path(folder_, entry.space, entry.key); }

// 0, ENOENT, or why not.
int DiskBound::remove(const std::string& path) {
    if (options_.before)
        if (const int code = options_.before(DiskStep::evict); code != 0) return code;
    return ::unlink(path.c_str()) == 0 ? 0 : errno;
}

Result<DiskBound::Found> DiskBound::scan() const {
    Found found;
    for (const Keyspace space : {Keyspace::action, Keyspace::blob}) {
        KILN_TRY(each_entry(folder_, space, [&](const std::string& path, const struct stat& info) {
            const auto key = Digest::from_hex(std::string_view(path).substr(path.size() - 64));
            const auto size = static_cast<uint64_t>(info.st_size);
            found.entries.push_back({space, *key, size, time_of(info)});
            found.use.add(size);
            return 0;
        }));
    }
    return found;
}

// Leaves in `found` what stays.
Status DiskBound::evict_from(Found& found, uint64_t target, DiskUse& evicted) {
    if (found.use.charged <= target) return {};
    std::sort(found.entries.begin(), found.entries.end(), [](const IndexEntry& a, const IndexEntry& b) {
        return std::tie(a.used, a.space, a.key) < std::tie(b.used, b.space, b.key);
    });
    uint64_t charged = found.use.charged;
    std::vector<IndexEntry> kept;
    int problem = 0;
    size_t stuck = 0;
    for (const IndexEntry& entry : found.entries) {
        if (charged <= target || stuck >= most_stuck) {
            kept.push_back(entry);
            continue;
        }
        if (const int code = remove(path_of(entry)); code != 0 && code != ENOENT) {
            problem = code;
            ++stuck;
            kept.push_back(entry);
            continue;
        }
        charged -= charge_of(entry.size);
        evicted.add(entry.size);
        ++evicted_;
    }
    found.entries = std::move(kept);
    found.use.charged = charged;
    if (charged > target && problem != 0) return io_error(folder_, "evict", problem);
    return {};
}

bool DiskBound::index_wanted(bool alone) {
    if (!looked_) {
        looked_ = true;
        index_off_ = !options_.index || !on_this_machine(folder_);
    }
    return alone && !index_off_;
}

void DiskBound::drop_index() {
    index_.reset();
    DiskIndex::erase(folder_);
    index_off_ = true;
    scanned_ = false;
}

Status DiskBound::ready_index() {
    if (options_.before)
        if (const int code = options_.before(DiskStep::account); code != 0) return io_error(folder_, "write the index of", code);
    if (index_ && !index_->still_there()) index_.reset();
    bool build = false;
    if (!index_) {
        auto opened = DiskIndex::open(folder_);
        KILN_TRY(opened);
        index_ = std::move(*opened);
        if (index_->built()) {
            auto change = index_->change();
            KILN_TRY(change);
            const int64_t age = now() - (*change)->totals().scanned;
            build = age > scan_at_least_every || age < -scan_at_least_every;
        }
    }
    if (build || !index_->built()) {
        const auto found = scan();
        KILN_TRY(found);
        KILN_TRY(index_->rebuild(found->entries, now()));
    }
    return {};
}

Status DiskBound::make_room(DiskIndex::Change& change, uint64_t target) {
    size_t stuck = 0;
    while (change.totals().charged > target) {
        auto oldest = change.oldest();
        KILN_TRY(oldest);
        if (!oldest->has_value()) return {};
        IndexEntry entry = **oldest;
        const std::string path = path_of(entry);
        struct stat info {};
        const bool there = ::lstat(path.c_str(), &info) == 0;
        if (there && time_of(info) > entry.used) {  // used since
            entry.used = time_of(info);
            entry.size = static_cast<uint64_t>(info.st_size);
            KILN_TRY(change.put(entry));
            continue;
        }
        if (const int code = there ? remove(path) : ENOENT; code != 0 && code != ENOENT) {
            if (++stuck > most_stuck) return io_error(path, "evict", code);
            entry.used = now();
            KILN_TRY(change.put(entry));
            continue;
        }
        KILN_TRY(change.remove(entry.space, entry.key));
        evicted_ += there;
    }
    return {};
}

Status DiskBound::admit_by_index(const IndexEntry& entry) {
    KILN_TRY(ready_index());
    auto change = index_->change();
    KILN_TRY(change);
    // While an entry is being replaced, the larger of the two counts: the new one may never get its name.
    IndexEntry row = entry;
    auto old = (*change)->find(entry.space, entry.key);
    KILN_TRY(old);
    if (old->has_value()) row.size = std::max(row.size, (*old)->size);
    const uint64_t more = charge_of(row.size) - (old->has_value() ? charge_of((*old)->size) : 0);
    if (options_.limit != 0 && (*change)->totals().charged + more > options_.limit) {
        const uint64_t low = low_watermark(options_.limit);
        const uint64_t charge = charge_of(row.size);
        KILN_TRY((*change)->remove(entry.space, entry.key));
        const Status room = make_room(**change, low > charge ? low - charge : 0);
        if (!room.ok()) {
            (void)(*change)->commit();
            return room;
        }
    }
    KILN_TRY((*change)->put(row));
    return (*change)->commit();
}

Status DiskBound::admit_by_scan(const IndexEntry& entry) {
    const uint64_t charge = charge_of(entry.size);
    if (options_.limit == 0) return {};
    if (!scanned_ || since_scan_ > options_.limit / 16 || estimate_ + charge > options_.limit) {
        auto found = scan();
        KILN_TRY(found);
        if (found->use.charged + charge > options_.limit) {
            const uint64_t low = low_watermark(options_.limit);
            DiskUse evicted;
            KILN_TRY(evict_from(*found, low > charge ? low - charge : 0, evicted));
        }
        estimate_ = found->use.charged;
        since_scan_ = 0;
        scanned_ = true;
    }
    estimate_ += charge;
    since_scan_ += charge;
    return {};
}

Status DiskBound::admit(Keyspace space, const Digest& key, uint64_t size, bool alone) {
    if (options_.limit != 0 && charge_of(size) > options_.limit)
        return environment_error("cache: an entry of " + std::to_string(size) + " bytes does not fit into a cache of " +
                                 std::to_string(options_.limit));
    const IndexEntry entry{space, key, size, now()};
    if (index_wanted(alone)) {
        if (admit_by_index(entry).ok()) return {};
        drop_index();
    }
    return admit_by_scan(entry);
}

void DiskBound::forget(Keyspace space, const Digest& key, bool alone) {
    // A row too many does no harm, so an index that is not open stays closed.
    if (!index_ || !alone || !index_->still_there()) return;
    auto change = index_->change();
    if (!change.ok() || !(*change)->remove(space, key).ok() || !(*change)->commit().ok()) drop_index();
}

Result<DiskBound::Shrunk> DiskBound::shrink(uint64_t target, bool alone) {
    auto found = scan();
    KILN_TRY(found);
    Shrunk shrunk;
    shrunk.before = found->use;
    const Status status = evict_from(*found, target, shrunk.evicted);
    scanned_ = false;
    if (index_wanted(alone)) {
        if (index_ && !index_->still_there()) index_.reset();
        if (!index_) {
            auto opened = DiskIndex::open(folder_);
            if (opened.ok()) index_ = std::move(*opened);
        }
        if (!index_ || !index_->rebuild(found->entries, now()).ok()) drop_index();
    }
    KILN_TRY(status);
    return shrunk;
}

void DiskBound::close() {
    if (index_) index_->close();
    index_.reset();
}

void DiskBound::reset() {
    index_.reset();
    DiskIndex::erase(folder_);
    scanned_ = false;
}

}  // namespace kiln
