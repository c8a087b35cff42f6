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

std::string temporary_name() {
    // Collisions only cost another try, since drafts are created exclusively: a clock, a process and a count are enough.
    static std::atomic<uint64_t> serial{0};
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    const uint64_t parts[] = {static_cast<uint64_t>(now.tv_sec), static_cast<uint64_t>(now.tv_nsec),
                              static_cast<uint64_t>(::getpid()), serial++};
    const uint64_t value = xxh3({reinterpret_cast<const uint8_t*>(parts), sizeof parts}).low;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
    return text + std::string(temporary_suffix);
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

}  // namespace kiln
