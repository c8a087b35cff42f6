// Reading takes no lock: an entry's name always stands for a whole file. What is damaged is moved under the lock, and only after
// it was read again there, so that a good entry that another process has just put in its place stays.
#include "cache/disk_read.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "cache/disk_entry.h"
#include "cache/disk_folder.h"

namespace kiln {

namespace {

constexpr uint64_t largest_entry = uint64_t{1} << 30;
constexpr int64_t renew_after = int64_t{60} * 1'000'000'000;  // a use within a minute of the last is not written down

void renew(int fd, const struct stat& info, int64_t now) {
    if (now - time_of(info) > renew_after) (void)set_time(fd, now);  // fails where another user owns the file
}

}  // namespace

DiskStore::Reading DiskStore::read(Keyspace space, const Digest& key, bool use) const {
    Reading got;
    const std::string path = path_of(space, key);
    const auto failed = [&](const char* doing) {
        got.is = Reading::Is::failed;
        got.error = io_error(path, doing, errno);
        return got;
    };
    // Non-blocking, so that a pipe under an entry's name cannot hang a build.
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (fd.get() < 0) return errno == ENOENT || errno == ENOTDIR ? got : failed("open");
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return failed("inspect");
    got.is = Reading::Is::damaged;
    got.reason = "it is no regular file";
    if (!S_ISREG(info.st_mode)) return got;
    got.reason = "it is larger than 1 GiB";
    if (static_cast<uint64_t>(info.st_size) > largest_entry) return got;
    got.file.resize(static_cast<size_t>(info.st_size));
    if (!read_all(fd.get(), got.file)) return failed("read");
    got.reason = entry_problem(space, key, got.file);
    if (!got.reason.empty()) return got;
    got.is = Reading::Is::whole;
    if (use) renew(fd.get(), info, now());
    return got;
}

Result<std::optional<Bytes>> DiskStore::load(Keyspace space, const Digest& key) {
    Reading got = read(space, key, true);
    if (got.is == Reading::Is::damaged) got = mended(space, key);
    if (got.is == Reading::Is::failed) return got.error;
    if (got.is != Reading::Is::whole) return std::optional<Bytes>();
    if (space == Keyspace::action) got.file.erase(got.file.begin(), got.file.begin() + action_head_size);
    return std::optional<Bytes>(std::move(got.file));
}

Result<std::optional<uint64_t>> DiskStore::find(Keyspace space, const Digest& key) {
    const std::string path = path_of(space, key);
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (fd.get() < 0 && errno != ENOENT && errno != ENOTDIR) return io_error(path, "open", errno);
    struct stat info {};
    if (fd.get() < 0 || ::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode)) return std::optional<uint64_t>();
    renew(fd.get(), info, now());
    const auto size = static_cast<uint64_t>(info.st_size);
    if (space == Keyspace::blob) return std::optional<uint64_t>(size);
    return size < action_head_size ? std::nullopt : std::optional<uint64_t>(size - action_head_size);
}

// What the entry is when read under the lock; a damaged file has then been moved to `kept`, which stays empty when that failed.
DiskStore::Reading DiskStore::set_aside(Keyspace space, const Digest& key, std::string& kept) {
    auto held = lock_.take();
    Reading got = read(space, key, true);
    if (got.is != Reading::Is::damaged || !held.ok()) return got;
    const std::string path = path_of(space, key);
    struct stat info {};
    if (::lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode) || step(DiskStep::quarantine) != 0) return got;
    const std::string target = folder_ + "/quarantine/" + quarantine_name(space, key);
    std::error_code ignored;
    std::filesystem::create_directories(folder_ + "/quarantine", ignored);
    // Where there is no room to keep it, it still may not stay: the entry is what must be right.
    if (::rename(path.c_str(), target.c_str()) == 0)
        kept = target;
    else if (errno == EACCES || errno == EROFS || errno == EPERM || ::unlink(path.c_str()) != 0)
        return got;
    bound_.forget(space, key, held->among_processes());
    trim_quarantine();
    return got;
}

// What a damaged entry is after all; one that is still damaged was set aside, counted and told.
DiskStore::Reading DiskStore::mended(Keyspace space, const Digest& key) {
    Damage damage{path_of(space, key), {}, {}};
    Reading got = set_aside(space, key, damage.kept);
    if (got.is != Reading::Is::damaged) return got;
    ++corrupt_;
    damage.reason = got.reason;
    if (on_damage) on_damage(damage);
    return got;
}

void DiskStore::trim_quarantine() const {
    std::vector<std::pair<int64_t, std::string>> files;
    uint64_t charged = 0;
    const Status listed = each_quarantined(folder_, [&](const std::string& path, const struct stat& info) {
        // The time of the rename, not of the entry's last use.
        files.emplace_back(int64_t{info.st_ctim.tv_sec} * 1'000'000'000 + info.st_ctim.tv_nsec, path);
        charged += charge_of(static_cast<uint64_t>(info.st_size));
        return 0;
    });
    const uint64_t room = options_.limit == 0 ? default_cache_limit : options_.limit;
    if (!listed.ok() || (files.size() <= most_quarantined && charged <= room / 16)) return;
    std::sort(files.begin(), files.end());
    for (size_t i = 0; i + 1 < files.size() && (files.size() - i > most_quarantined || charged > room / 16); ++i) {
        struct stat info {};
        if (::lstat(files[i].second.c_str(), &info) == 0)
            charged -= std::min(charged, charge_of(static_cast<uint64_t>(info.st_size)));
        ::unlink(files[i].second.c_str());
    }
}

Result<DiskStore::Verified> DiskStore::verify() {
    Verified out;
    for (const Keyspace space : {Keyspace::action, Keyspace::blob}) {
        KILN_TRY(each_entry(folder_, space, [&](const std::string& path, const struct stat& info) {
            const auto key = Digest::from_hex(std::string_view(path).substr(path.size() - 64));
            Reading got = read(space, *key, false);
            Damage damage{path, got.reason, {}};
            if (got.is == Reading::Is::damaged) got = set_aside(space, *key, damage.kept);
            if (got.is == Reading::Is::absent) return 0;  // evicted meanwhile
            out.checked.add(static_cast<uint64_t>(info.st_size));
            if (got.is == Reading::Is::damaged) {
                ++corrupt_;
                out.damaged.push_back(std::move(damage));
            } else if (got.is == Reading::Is::failed) {
                damage.reason = got.error.message;
                out.unreadable.push_back(std::move(damage));
            }
            return 0;
        }));
    }
    const auto by_path = [](const Damage& a, const Damage& b) { return a.path < b.path; };
    std::sort(out.damaged.begin(), out.damaged.end(), by_path);
    std::sort(out.unreadable.begin(), out.unreadable.end(), by_path);
    return out;
}

}  // namespace kiln
