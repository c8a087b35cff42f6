// Publishing is write, close, rename, with no flush between: some thousands of entries of a few KiB cost 13,000 a second
// this way and 2,000 with fdatasync, and what a flush would save from a power cut the check on the next read finds.
// An entry that fails the check is unlinked without a lock. Another process may have replaced it by a good one in that
// moment; then a good entry is lost, which is a miss.
#include "cache/disk_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "cache/disk_entry.h"
#include "cache/disk_folder.h"

namespace kiln {

namespace {

namespace fs = std::filesystem;

constexpr uint64_t largest_entry = uint64_t{1} << 30;
constexpr time_t stale_after = 3600;  // seconds

}  // namespace

std::string default_cache_folder() {
    for (const auto& [variable, below] : {std::pair{"XDG_CACHE_HOME", "/kiln"}, std::pair{"HOME", "/.cache/kiln"}}) {
        const char* value = std::getenv(variable);
        if (value != nullptr && value[0] == '/') return std::string(value) + below;  // XDG: a relative path is ignored
    }
    return {};
}

Result<std::unique_ptr<DiskStore>> DiskStore::open(const std::string& folder) {
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
    auto store = std::unique_ptr<DiskStore>(new DiskStore(path));
    store->sweep_temporaries();
    return store;
}

std::string DiskStore::entry_path(Keyspace space, const Digest& key) const {
    const std::string hex = key.hex();
    return folder_ + "/" + folder_name(space) + "/" + hex.substr(0, 2) + "/" + hex;
}

Result<std::optional<Bytes>> DiskStore::get(Keyspace space, const Digest& key) {
    auto got = load(space, key);
    if (!got.ok())
        ++failures_;
    else
        ++(got->has_value() ? hits_ : misses_);
    return got;
}

Result<std::optional<Bytes>> DiskStore::load(Keyspace space, const Digest& key) {
    const std::string path = entry_path(space, key);
    const std::optional<Bytes> absent;
    // Non-blocking, so that a pipe under an entry's name cannot hang a build.
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (fd.get() < 0) {
        if (errno == ENOENT || errno == ENOTDIR) return absent;
        return io_error(path, "open", errno);
    }
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return io_error(path, "inspect", errno);
    if (S_ISREG(info.st_mode) && static_cast<uint64_t>(info.st_size) <= largest_entry) {
        Bytes file(static_cast<size_t>(info.st_size));
        if (!read_all(fd.get(), file)) return io_error(path, "read", errno);
        if (space == Keyspace::blob) {
            if (sha256(file) == key) return std::optional<Bytes>(std::move(file));
        } else if (action_payload(key, file)) {
            file.erase(file.begin(), file.begin() + action_head_size);
            return std::optional<Bytes>(std::move(file));
        }
    }
    ++corrupt_;
    ::unlink(path.c_str());
    return absent;
}

Status DiskStore::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (bytes.size() > largest_entry - action_head_size) {
        ++failures_;
        return environment_error("cache: an entry of " + std::to_string(bytes.size()) + " bytes is too large");
    }
    const std::string path = entry_path(space, key);
    Bytes head;
    if (space == Keyspace::action) {
        head = action_head(key, bytes);
    } else {
        if (sha256(bytes) != key) {
            ++failures_;
            return environment_error("cache: a blob does not match its name " + key.hex());
        }
        struct stat info {};
        if (::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && static_cast<uint64_t>(info.st_size) == bytes.size()) {
            ++already_there_;
            return {};
        }
    }
    const Status status = publish(path, head, bytes);
    ++(status.ok() ? written_ : failures_);
    return status;
}

Status DiskStore::publish(const std::string& path, ByteView head, ByteView body) {
    const std::string drafts = folder_ + "/tmp";
    std::string draft;
    int raw = -1;
    for (int attempt = 0; attempt < 8 && raw < 0; ++attempt) {
        draft = drafts + "/" + temporary_name();
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
    int code = 0;
    const auto done = [&] {
        if (!write_all(fd.get(), head) || !write_all(fd.get(), body) || !fd.close()) return false;
        if (::rename(draft.c_str(), path.c_str()) == 0) return true;
        if (errno != ENOENT) return false;
        std::error_code failed;
        fs::create_directories(fs::path(path).parent_path(), failed);
        if (failed) {
            errno = failed.value();
            return false;
        }
        return ::rename(draft.c_str(), path.c_str()) == 0;
    };
    if (done()) return {};
    code = errno;
    ::unlink(draft.c_str());
    return io_error(path, "write", code);
}

// What a killed process left. A live one renames its file within moments; an hour allows for a suspended machine.
void DiskStore::sweep_temporaries() const {
    const time_t now = std::time(nullptr);
    const Status swept = each_temporary(folder_, [&](const std::string& path, const struct stat& info) {
        if (info.st_mtime + stale_after < now) ::unlink(path.c_str());
        return 0;
    });
    (void)swept;  // best effort: a folder that cannot be read is reported by whoever needs it
}

Result<DiskStore::Stats> DiskStore::stats() const {
    Stats stats;
    const auto add = [](Use& use) {
        return [&use](const std::string&, const struct stat& info) {
            ++use.entries;
            use.bytes += static_cast<uint64_t>(info.st_size);
            return 0;
        };
    };
    KILN_TRY(each_entry(folder_, Keyspace::action, add(stats.action)));
    KILN_TRY(each_entry(folder_, Keyspace::blob, add(stats.blob)));
    KILN_TRY(each_temporary(folder_, add(stats.temporary)));
    return stats;
}

Result<DiskStore::Stats> DiskStore::clear() {
    Stats removed;
    const auto remove = [](Use& use) {
        return [&use](const std::string& path, const struct stat& info) {
            if (::unlink(path.c_str()) != 0) return errno == ENOENT ? 0 : errno;
            ++use.entries;
            use.bytes += static_cast<uint64_t>(info.st_size);
            return 0;
        };
    };
    KILN_TRY(each_entry(folder_, Keyspace::action, remove(removed.action)));
    KILN_TRY(each_entry(folder_, Keyspace::blob, remove(removed.blob)));
    KILN_TRY(each_temporary(folder_, remove(removed.temporary)));
    return removed;
}

DiskStore::Counters DiskStore::counters() const {
    return {hits_.load(), misses_.load(), corrupt_.load(), written_.load(), already_there_.load(), failures_.load()};
}

}  // namespace kiln
