// Names are checked to the last digit before a file is counted or removed: a folder that holds something else as well,
// or that was given by mistake, keeps what is not the store's.
#include "cache/disk_folder.h"

#include <dirent.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

namespace kiln {

namespace {

constexpr std::string_view temporary_suffix = ".part";

bool is_hex(std::string_view text, size_t digits) {
    return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_temporary(std::string_view name) {
    return name.size() == 16 + temporary_suffix.size() && is_hex(name.substr(0, 16), 16) && name.substr(16) == temporary_suffix;
}

bool is_quarantined(std::string_view name) {
    for (const Keyspace space : {Keyspace::action, Keyspace::blob}) {
        const std::string_view prefix = folder_name(space);
        if (name.size() == prefix.size() + 1 + 64 + 1 + 16 && name.substr(0, prefix.size()) == prefix)
            return is_hex(name.substr(prefix.size() + 1, 64), 64) && is_hex(name.substr(prefix.size() + 66), 16);
    }
    return false;
}

Status names_in(const std::string& folder, std::vector<std::string>& names) {
    DIR* dir = ::opendir(folder.c_str());
    if (dir == nullptr) {
        if (errno == ENOENT || errno == ENOTDIR) return {};
        return io_error(folder, "list", errno);
    }
    while (const dirent* entry = ::readdir(dir)) names.emplace_back(entry->d_name);
    ::closedir(dir);
    return {};
}

Status each_file(const std::string& folder, const std::function<bool(std::string_view)>& wanted, const Visit& visit) {
    std::vector<std::string> names;
    KILN_TRY(names_in(folder, names));
    for (const std::string& name : names) {
        if (!wanted(name)) continue;
        const std::string path = folder + "/" + name;
        struct stat info {};
        if (::lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;  // gone, or not ours
        if (const int code = visit(path, info); code != 0) return io_error(path, "remove", code);
    }
    return {};
}

}  // namespace

Error io_error(const std::string& path, const char* doing, int code) {
    return environment_error("cache: " + path + ": cannot " + doing + ": " + std::strerror(code));
}

const char* folder_name(Keyspace space) { return space == Keyspace::action ? "action" : "blob"; }

std::string entry_path(const std::string& folder, Keyspace space, const Digest& key) {
    const std::string hex = key.hex();
    return folder + "/" + folder_name(space) + "/" + hex.substr(0, 2) + "/" + hex;
}

int64_t system_time() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

int64_t time_of(const struct stat& info) { return int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + info.st_mtim.tv_nsec; }

bool set_time(int fd, int64_t time) {
    const timespec both{time / 1'000'000'000, time % 1'000'000'000};
    const timespec times[] = {both, both};
    return ::futimens(fd, times) == 0;
}

std::string unique_name() {
    // Collisions only cost another try, since drafts are created exclusively: a clock, a process and a count are enough.
    static std::atomic<uint64_t> serial{0};
    const uint64_t parts[] = {static_cast<uint64_t>(system_time()), static_cast<uint64_t>(::getpid()), serial++};
    const uint64_t value = xxh3({reinterpret_cast<const uint8_t*>(parts), sizeof parts}).low;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
    return text;
}

std::string temporary_name() { return unique_name() + std::string(temporary_suffix); }

std::string quarantine_name(Keyspace space, const Digest& key) {
    return folder_name(space) + ("-" + key.hex()) + "-" + unique_name();
}

bool Descriptor::close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || ::close(fd) == 0;
}

bool write_all(int fd, ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(n));
    }
    return true;
}

bool read_all(int fd, Bytes& out) {
    size_t done = 0;
    while (done < out.size()) {
        const ssize_t n = ::read(fd, out.data() + done, out.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return false;
        if (n == 0) break;
        done += static_cast<size_t>(n);
    }
    out.resize(done);
    return true;
}

Status each_entry(const std::string& folder, Keyspace space, const Visit& visit) {
    const std::string top = folder + "/" + folder_name(space);
    std::vector<std::string> shards;
    KILN_TRY(names_in(top, shards));
    for (const std::string& shard : shards) {
        if (!is_hex(shard, 2)) continue;
        KILN_TRY(each_file(
            top + "/" + shard, [&](std::string_view name) { return is_hex(name, 64) && name.substr(0, 2) == shard; }, visit));
    }
    return {};
}

Status each_temporary(const std::string& folder, const Visit& visit) { return each_file(folder + "/tmp", is_temporary, visit); }

Status each_quarantined(const std::string& folder, const Visit& visit) {
    return each_file(folder + "/quarantine", is_quarantined, visit);
}

}  // namespace kiln
