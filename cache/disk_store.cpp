// The slow part of publishing, writing and flushing, happens before the lock is taken; under it an entry is counted and renamed,
// some tens of microseconds. Since everybody who removes a file holds the lock as well, a name that was given stays until it is
// evicted.
#include "cache/disk_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "cache/disk_entry.h"
#include "cache/disk_folder.h"
#include "cache/disk_read.h"

namespace kiln {

namespace {

namespace fs = std::filesystem;

constexpr uint64_t largest_payload = (uint64_t{1} << 30) - action_head_size;
constexpr int64_t stale_after = int64_t{3600} * 1'000'000'000;

bool same(ByteView file, ByteView head, ByteView body) {
    return file.size() == head.size() + body.size() && as_text(file.first(head.size())) == as_text(head) &&
           as_text(file.subspan(head.size())) == as_text(body);
}

// So that the names in `folder` survive a power cut. 0, or the errno.
int flush_folder(const std::string& folder) {
    const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    return fd.get() >= 0 && ::fsync(fd.get()) == 0 ? 0 : errno;
}

}  // namespace

std::string default_cache_folder() {
    for (const auto& [variable, below] : {std::pair{"XDG_CACHE_HOME", "/kiln"}, std::pair{"HOME", "/.cache/kiln"}}) {
        const char* value = std::getenv(variable);
        if (value != nullptr && value[0] == '/') return std::string(value) + below;  // XDG: a relative path is ignored
    }
    return {};
}

DiskStore::DiskStore(std::string folder, DiskOptions options)
    : folder_(std::move(folder)),
      options_(std::move(options)),
      lock_(folder_ + "/lock", options_.lock_wait),
      bound_(folder_, options_) {}

DiskStore::~DiskStore() {
    if (!bound_.has_index()) return;
    if (const auto held = lock_.take(); held.ok()) bound_.close();
}

Result<std::unique_ptr<DiskStore>> DiskStore::open(const std::string& folder, DiskOptions options) {
    if (folder.empty()) return environment_error("cache: no folder given");
    std::error_code failed;
    const std::string path = fs::absolute(folder, failed).lexically_normal().string();
    if (failed) return environment_error("cache: " + folder + ": " + failed.message());
    fs::create_directories(path, failed);
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0)
        return failed ? environment_error("cache: " + path + ": cannot create: " + failed.message())
                      : io_error(path, "open", errno);
    if (!S_ISDIR(info.st_mode)) return environment_error("cache: " + path + ": is not a folder");
    if (::access(path.c_str(), R_OK | X_OK) != 0) return io_error(path, "open", errno);
    auto store = std::unique_ptr<DiskStore>(new DiskStore(path, std::move(options)));
    store->sweep_temporaries();
    return store;
}

int64_t DiskStore::now() const { return options_.now ? options_.now() : system_time(); }

Result<std::optional<Bytes>> DiskStore::get(Keyspace space, const Digest& key) {
    auto got = load(space, key);
    if (!got.ok())
        ++failures_;
    else
        ++(got->has_value() ? hits_ : misses_);
    return got;
}

Status DiskStore::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (space != Keyspace::blob) return keep(space, key, bytes);
    if (const auto blob = HashedBlob::of(key, bytes)) return put(*blob);
    ++failures_;
    return environment_error("cache: a blob does not match its name " + key.hex());
}

Status DiskStore::keep(Keyspace space, const Digest& key, ByteView bytes) {
    if (bytes.size() > largest_payload) {
        ++failures_;
        return environment_error("cache: an entry of " + std::to_string(bytes.size()) + " bytes is too large");
    }
    const Bytes head = space == Keyspace::action ? action_head(key, bytes) : Bytes();
    Reading there = read(space, key, true);
    if (there.is == Reading::Is::damaged) there = mended(space, key);
    if (there.is == Reading::Is::whole && same(there.file, head, bytes)) {
        ++already_there_;
        return {};
    }
    const Status status = publish(space, key, head, bytes);
    ++(status.ok() ? written_ : failures_);
    return status;
}

Status DiskStore::publish(Keyspace space, const Digest& key, ByteView head, ByteView body) {
    const std::string drafts = folder_ + "/tmp";
    std::string draft;
    int raw = -1;
    for (int attempt = 0; attempt < 8 && raw < 0; ++attempt) {
        draft = drafts + "/" + temporary_name();
        if (const int code = step(DiskStep::create); code != 0) return io_error(drafts, "create a file", code);
        raw = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (raw >= 0) break;
        if (errno == ENOENT) {
            std::error_code failed;
            fs::create_directories(drafts, failed);
            if (failed) return io_error(drafts, "create", failed.value());
        } else if (errno != EEXIST) {
            return io_error(drafts, "create a file", errno);
        }
    }
    if (raw < 0) return io_error(drafts, "create a file", errno);
    Descriptor fd(raw);
    const auto fails = [&](DiskStep which) {
        errno = step(which);
        return errno != 0;
    };
    const auto write = [&] {
        if (fails(DiskStep::write) || !write_all(fd.get(), head) || !write_all(fd.get(), body)) return false;
        (void)set_time(fd.get(), now());
        if (options_.sync != Sync::none && (fails(DiskStep::sync) || ::fdatasync(fd.get()) != 0)) return false;
        return fd.close();
    };
    Status status =
        write() ? name_draft(space, key, draft, head.size() + body.size()) : io_error(path_of(space, key), "write", errno);
    if (!status.ok()) ::unlink(draft.c_str());
    return status;
}

Status DiskStore::name_draft(Keyspace space, const Digest& key, const std::string& draft, uint64_t size) {
    const std::string path = path_of(space, key), shard = fs::path(path).parent_path();
    bool new_shard = false;
    {
        if (const int code = step(DiskStep::lock); code != 0) return io_error(folder_, "lock", code);
        const auto held = lock_.take();
        KILN_TRY(held);
        const Status admitted = bound_.admit(space, key, size, held->among_processes());
        evicted_ = bound_.evicted();
        KILN_TRY(admitted);
        struct stat written {
        }, named{};
        if (::lstat(draft.c_str(), &written) != 0) return io_error(draft, "inspect", errno);
        if (const int code = step(DiskStep::rename); code != 0) return io_error(path, "write", code);
        int code = ::rename(draft.c_str(), path.c_str()) == 0 ? 0 : errno;
        if (code == ENOENT) {
            std::error_code failed;
            new_shard = fs::create_directories(shard, failed);
            if (failed) return io_error(shard, "create", failed.value());
            code = ::rename(draft.c_str(), path.c_str()) == 0 ? 0 : errno;
        }
        // A network file system that sent the request twice reports the second one's failure.
        const bool arrived = code == ENOENT && ::lstat(path.c_str(), &named) == 0 && named.st_ino == written.st_ino &&
                             named.st_dev == written.st_dev;
        if (code != 0 && !arrived) return io_error(path, "write", code);
    }
    return options_.sync == Sync::folder ? flush_names(space, key, new_shard) : Status();
}

// A shard that another process made may not have been flushed yet by it, so each process does that once for each shard.
Status DiskStore::flush_names(Keyspace space, const Digest& key, bool new_shard) {
    const std::string shard = fs::path(path_of(space, key)).parent_path();
    if (const int code = flush_folder(shard); code != 0) return io_error(shard, "flush", code);
    std::atomic<bool>& flushed = shard_flushed_[(space == Keyspace::action ? 0u : 256u) + key.bytes[0]];
    if (flushed && !new_shard) return {};
    for (std::string above = folder_ + "/" + folder_name(space); above.size() >= folder_.size();
         above = fs::path(above).parent_path())
        if (const int code = flush_folder(above); code != 0) return io_error(above, "flush", code);
    flushed = true;
    return {};
}

// What a killed process left. A live one renames its file within moments; an hour allows for a suspended machine.
void DiskStore::sweep_temporaries() const {
    const int64_t oldest = now() - stale_after;
    const Status swept = each_temporary(folder_, [&](const std::string& path, const struct stat& info) {
        if (time_of(info) < oldest) ::unlink(path.c_str());
        return 0;
    });
    (void)swept;  // best effort: a folder that cannot be read is reported by whoever needs it
}

Result<DiskStore::Stats> DiskStore::stats() const {
    Stats stats;
    const auto add = [](DiskUse& use) {
        return [&use](const std::string&, const struct stat& info) {
            use.add(static_cast<uint64_t>(info.st_size));
            return 0;
        };
    };
    KILN_TRY(each_entry(folder_, Keyspace::action, add(stats.action)));
    KILN_TRY(each_entry(folder_, Keyspace::blob, add(stats.blob)));
    KILN_TRY(each_temporary(folder_, add(stats.temporary)));
    KILN_TRY(each_quarantined(folder_, add(stats.quarantine)));
    return stats;
}

Result<DiskStore::Shrunk> DiskStore::gc(uint64_t target) {
    sweep_temporaries();
    const auto held = lock_.take();
    KILN_TRY(held);
    auto shrunk = bound_.shrink(target, held->among_processes());
    evicted_ = bound_.evicted();
    return shrunk;
}

Result<DiskStore::Stats> DiskStore::clear() {
    const auto held = lock_.take();
    KILN_TRY(held);
    Stats removed;
    const auto remove = [](DiskUse& use) {
        return [&use](const std::string& path, const struct stat& info) {
            if (::unlink(path.c_str()) != 0) return errno == ENOENT ? 0 : errno;
            use.add(static_cast<uint64_t>(info.st_size));
            return 0;
        };
    };
    KILN_TRY(each_entry(folder_, Keyspace::action, remove(removed.action)));
    KILN_TRY(each_entry(folder_, Keyspace::blob, remove(removed.blob)));
    KILN_TRY(each_temporary(folder_, remove(removed.temporary)));
    KILN_TRY(each_quarantined(folder_, remove(removed.quarantine)));
    bound_.reset();
    return removed;
}

DiskStore::Counters DiskStore::counters() const {
    return {hits_.load(),          misses_.load(),  corrupt_.load(), written_.load(),
            already_there_.load(), evicted_.load(), failures_.load()};
}

}  // namespace kiln
