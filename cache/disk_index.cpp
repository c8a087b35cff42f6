#include "cache/disk_index.h"

#include <fcntl.h>
#include <lmdb.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>

#include "cache/disk_clean.h"
#include "cache/disk_folder.h"
#include "cache/disk_options.h"

namespace kiln {

namespace {

constexpr size_t map_size = sizeof(void*) > 4 ? size_t{1} << 30 : size_t{1} << 28;  // address space, not memory

MDB_env* env_of(void* environment) { return static_cast<MDB_env*>(environment); }
MDB_txn* txn_of(void* transaction) { return static_cast<MDB_txn*>(transaction); }

Error index_error(const char* doing, int code) {
    return environment_error(std::string("cache: index: cannot ") + doing + ": " + ::mdb_strerror(code));
}

// Rows are in the machine's own byte order, but for the time in `order`, whose bytes sort.
using EntryKey = std::array<uint8_t, 33>;
using OrderKey = std::array<uint8_t, 41>;
struct EntryRow {
    uint64_t size;
    int64_t used;
};
constexpr uint8_t totals_key = 0xff;  // no keyspace

EntryKey entry_key(Keyspace space, const Digest& key) {
    EntryKey out;
    out[0] = static_cast<uint8_t>(space);
    std::memcpy(out.data() + 1, key.bytes.data(), key.bytes.size());
    return out;
}

OrderKey order_key(const IndexEntry& entry) {
    OrderKey out;
    const uint64_t time = static_cast<uint64_t>(entry.used) ^ (uint64_t{1} << 63);
    for (unsigned i = 0; i < 8; ++i) out[i] = static_cast<uint8_t>(time >> (56 - 8 * i));
    const EntryKey key = entry_key(entry.space, entry.key);
    std::memcpy(out.data() + 8, key.data(), key.size());
    return out;
}

template <class T>
MDB_val view(T& value) {
    return {sizeof value, const_cast<std::remove_const_t<T>*>(&value)};
}

std::string data_file(const std::string& folder) { return folder + "/data.mdb"; }

}  // namespace

DiskIndex::Change::~Change() {
    if (transaction_ != nullptr) ::mdb_txn_abort(txn_of(transaction_));
}

Result<std::optional<IndexEntry>> DiskIndex::Change::find(Keyspace space, const Digest& key) {
    const EntryKey name = entry_key(space, key);
    MDB_val k = view(name), v{};
    const int code = ::mdb_get(txn_of(transaction_), index_.entries_, &k, &v);
    if (code == MDB_NOTFOUND) return std::optional<IndexEntry>();
    if (code != 0) return index_error("read", code);
    EntryRow row;
    if (v.mv_size != sizeof row) return index_error("read", MDB_CORRUPTED);
    std::memcpy(&row, v.mv_data, sizeof row);
    return std::optional<IndexEntry>({space, key, row.size, row.used});
}

Result<std::optional<IndexEntry>> DiskIndex::Change::oldest() {
    MDB_cursor* cursor = nullptr;
    if (const int code = ::mdb_cursor_open(txn_of(transaction_), index_.order_, &cursor); code != 0)
        return index_error("read", code);
    MDB_val k{}, v{};
    const int code = ::mdb_cursor_get(cursor, &k, &v, MDB_FIRST);
    OrderKey name;
    const bool fits = code == 0 && k.mv_size == name.size();
    if (fits) std::memcpy(name.data(), k.mv_data, name.size());
    ::mdb_cursor_close(cursor);
    if (code == MDB_NOTFOUND) return std::optional<IndexEntry>();
    if (code != 0 || !fits || name[8] > 1) return index_error("read", code != 0 ? code : MDB_CORRUPTED);
    Digest key;
    std::memcpy(key.bytes.data(), name.data() + 9, key.bytes.size());
    auto found = find(static_cast<Keyspace>(name[8]), key);
    if (found.ok() && !found->has_value()) return index_error("read", MDB_CORRUPTED);
    return found;
}

Status DiskIndex::Change::put(const IndexEntry& entry) {
    KILN_TRY(remove(entry.space, entry.key));
    const EntryKey name = entry_key(entry.space, entry.key);
    const OrderKey order = order_key(entry);
    const EntryRow row{entry.size, entry.used};
    MDB_val k = view(name), v = view(row);
    if (const int code = ::mdb_put(txn_of(transaction_), index_.entries_, &k, &v, 0); code != 0)
        return index_error("write", code);
    k = view(order);
    v = {0, nullptr};
    if (const int code = ::mdb_put(txn_of(transaction_), index_.order_, &k, &v, 0); code != 0) return index_error("write", code);
    ++totals_.entries;
    totals_.charged += charge_of(entry.size);
    return {};
}

Status DiskIndex::Change::remove(Keyspace space, const Digest& key) {
    const auto old = find(space, key);
    KILN_TRY(old);
    if (!old->has_value()) return {};
    const EntryKey name = entry_key(space, key);
    const OrderKey order = order_key(**old);
    MDB_val k = view(name);
    if (const int code = ::mdb_del(txn_of(transaction_), index_.entries_, &k, nullptr); code != 0)
        return index_error("write", code);
    k = view(order);
    if (const int code = ::mdb_del(txn_of(transaction_), index_.order_, &k, nullptr); code != 0)
        return index_error("write", code);
    --totals_.entries;
    totals_.charged -= charge_of((*old)->size);
    return {};
}

Status DiskIndex::Change::commit() {
    MDB_val k = view(totals_key), v = view(totals_);
    if (const int code = ::mdb_put(txn_of(transaction_), index_.entries_, &k, &v, 0); code != 0)
        return index_error("write", code);
    const int code = ::mdb_txn_commit(txn_of(std::exchange(transaction_, nullptr)));
    if (code != 0) return index_error("write", code);
    struct stat info {};
    if (::stat(data_file(index_.folder_).c_str(), &info) == 0) index_.length_ = static_cast<uint64_t>(info.st_size);
    return {};
}

Result<std::unique_ptr<DiskIndex>> DiskIndex::open(const std::string& folder) {
    auto index = std::unique_ptr<DiskIndex>(new DiskIndex(folder + "/index"));
    KILN_TRY(index->start());
    return index;
}

Status DiskIndex::start() {
    std::error_code failed;
    std::filesystem::create_directories(folder_, failed);
    if (failed) return io_error(folder_, "create", failed.value());
    const std::string users = folder_ + "/users";
    users_ = ::open(users.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (users_ < 0) return io_error(users, "open", errno);
    const std::string data = data_file(folder_);
    if (::flock(users_, LOCK_EX | LOCK_NB) == 0) {
        const bool clean = is_clean(folder_, data);
        ::unlink(clean_file(folder_).c_str());
        if (!clean) ::unlink(data.c_str());
    }
    if (::flock(users_, LOCK_SH | LOCK_NB) != 0) return io_error(users, "lock", errno);

    MDB_env* env = nullptr;
    if (const int code = ::mdb_env_create(&env); code != 0) return index_error("open", code);
    environment_ = env;
    ::mdb_env_set_maxdbs(env, 2);
    ::mdb_env_set_mapsize(env, map_size);
    const unsigned flags = MDB_NOSUBDIR | MDB_NOLOCK | MDB_NOSYNC | MDB_NOTLS | MDB_NORDAHEAD;
    if (const int code = ::mdb_env_open(env, data.c_str(), flags, 0666); code != 0) return index_error("open", code);
    MDB_txn* txn = nullptr;
    if (const int code = ::mdb_txn_begin(env, nullptr, 0, &txn); code != 0) return index_error("open", code);
    int code = ::mdb_dbi_open(txn, "entry", MDB_CREATE, &entries_);
    if (code == 0) code = ::mdb_dbi_open(txn, "order", MDB_CREATE, &order_);
    MDB_val k = view(totals_key), v{};
    if (code == 0) built_ = ::mdb_get(txn, entries_, &k, &v) == 0 && v.mv_size == sizeof(IndexTotals);
    if (code == 0)
        code = ::mdb_txn_commit(txn);
    else
        ::mdb_txn_abort(txn);
    if (code != 0) return index_error("open", code);
    struct stat info {};
    if (::stat(data.c_str(), &info) != 0) return io_error(data, "inspect", errno);
    inode_ = info.st_ino;
    length_ = static_cast<uint64_t>(info.st_size);
    return {};
}

DiskIndex::~DiskIndex() {
    if (environment_ != nullptr) ::mdb_env_close(env_of(environment_));
    if (users_ >= 0) ::close(users_);
}

bool DiskIndex::still_there() const {
    struct stat info {};
    return ::stat(data_file(folder_).c_str(), &info) == 0 && info.st_ino == inode_ &&
           static_cast<uint64_t>(info.st_size) >= length_;
}

Result<std::unique_ptr<DiskIndex::Change>> DiskIndex::begin() {
    auto change = std::unique_ptr<Change>(new Change(*this));
    MDB_txn* txn = nullptr;
    if (const int code = ::mdb_txn_begin(env_of(environment_), nullptr, 0, &txn); code != 0) return index_error("write", code);
    change->transaction_ = txn;
    return change;
}

Result<std::unique_ptr<DiskIndex::Change>> DiskIndex::change() {
    auto change = begin();
    KILN_TRY(change);
    MDB_val k = view(totals_key), v{};
    const int code = ::mdb_get(txn_of((*change)->transaction_), entries_, &k, &v);
    if (code != 0) return index_error("read", code);
    if (v.mv_size != sizeof(IndexTotals)) return index_error("read", MDB_CORRUPTED);
    std::memcpy(&(*change)->totals_, v.mv_data, sizeof(IndexTotals));
    return change;
}

Status DiskIndex::rebuild(const std::vector<IndexEntry>& entries, int64_t now) {
    auto change = begin();
    KILN_TRY(change);
    MDB_txn* txn = txn_of((*change)->transaction_);
    for (const unsigned table : {entries_, order_})
        if (const int code = ::mdb_drop(txn, table, 0); code != 0) return index_error("write", code);
    for (const IndexEntry& entry : entries) KILN_TRY((*change)->put(entry));
    (*change)->totals_.scanned = now;
    KILN_TRY((*change)->commit());
    built_ = true;
    return {};
}

void DiskIndex::close() {
    if (environment_ == nullptr) return;
    ::mdb_env_close(env_of(std::exchange(environment_, nullptr)));
    if (built_ && still_there() && ::flock(users_, LOCK_EX | LOCK_NB) == 0) mark_clean(folder_, data_file(folder_));
    ::close(std::exchange(users_, -1));
}

void DiskIndex::erase(const std::string& folder) {
    ::unlink(clean_file(folder + "/index").c_str());
    ::unlink(data_file(folder + "/index").c_str());
}

}  // namespace kiln
