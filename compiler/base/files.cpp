// Files are published by rename: a killed process leaves the old file or the new one, and at most a temporary
// name beside it that the next write of the same path by the same process id would replace.
#include "compiler/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace kiln {

namespace {

Error io_error(const std::string& path, const char* doing) {
    return environment_error(path + ": cannot " + doing + ": " + std::strerror(errno));
}

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { close(); }
    int get() const { return fd_; }
    bool close() {
        const int fd = fd_;
        fd_ = -1;
        return fd < 0 || ::close(fd) == 0;
    }

private:
    int fd_;
};

bool write_all(int fd, ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd, bytes.data(), bytes.size());
        if (n < 0) {
            if (errno == EINTR) continue;
            return false;
        }
        bytes = bytes.subspan(static_cast<size_t>(n));
    }
    return true;
}

}  // namespace

Result<std::optional<std::string>> DiskFiles::read(const std::string& path) {
    Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (fd.get() < 0) {
        if (errno == ENOENT || errno == ENOTDIR) return std::optional<std::string>();
        return io_error(path, "open");
    }
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return io_error(path, "inspect");
    if (S_ISDIR(info.st_mode)) return environment_error(path + ": is a folder");
    std::string text;
    if (info.st_size > 0) {
        if (static_cast<uint64_t>(info.st_size) > read_limit) return environment_error(path + ": larger than 4 GiB");
        text.reserve(static_cast<size_t>(info.st_size));
    }
    char buffer[1 << 16];
    for (;;) {
        const ssize_t n = ::read(fd.get(), buffer, sizeof buffer);
        if (n < 0) {
            if (errno == EINTR) continue;
            return io_error(path, "read");
        }
        if (n == 0) break;
        text.append(buffer, static_cast<size_t>(n));
        if (text.size() > read_limit) return environment_error(path + ": larger than 4 GiB");
    }
    return std::optional<std::string>(std::move(text));
}

Status DiskFiles::write(const std::string& path, ByteView bytes) {
    static std::atomic<unsigned> serial{0};
    const std::string folder = folder_of(path);
    if (!folder.empty()) {
        std::error_code failed;
        std::filesystem::create_directories(folder, failed);
        if (failed) return environment_error(folder + ": cannot create folder: " + failed.message());
    }
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) {
        // A device or a pipe (/dev/null, /dev/stdout) cannot be replaced by rename.
        if (S_ISDIR(info.st_mode)) return environment_error(path + ": is a folder");
        Descriptor fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
        if (fd.get() < 0 || !write_all(fd.get(), bytes)) return io_error(path, "write");
        return {};
    }
    const std::string temporary = path + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(serial++);
    Descriptor fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (fd.get() < 0) return io_error(path, "create");
    if (!write_all(fd.get(), bytes) || ::fdatasync(fd.get()) != 0 || !fd.close() ||
        ::rename(temporary.c_str(), path.c_str()) != 0) {
        const Error error = io_error(path, "write");
        ::unlink(temporary.c_str());
        return error;
    }
    return {};
}

Result<std::optional<std::string>> MemoryFiles::read(const std::string& path) {
    reads.push_back(path);
    const auto found = files.find(path);
    if (found == files.end()) return std::optional<std::string>();
    return std::optional<std::string>(found->second);
}

Status MemoryFiles::write(const std::string& path, ByteView bytes) {
    if (unwritable.count(path) != 0) return environment_error(path + ": cannot write: refused");
    files[path] = std::string(as_text(bytes));
    return {};
}

std::string normal_path(std::string_view path) {
    const bool absolute = !path.empty() && path.front() == '/';
    std::vector<std::string_view> parts;
    size_t begin = 0;
    while (begin <= path.size()) {
        size_t end = path.find('/', begin);
        if (end == std::string_view::npos) end = path.size();
        const std::string_view part = path.substr(begin, end - begin);
        if (part == "..") {
            if (!parts.empty() && parts.back() != "..")
                parts.pop_back();
            else if (!absolute)
                parts.push_back(part);
        } else if (!part.empty() && part != ".") {
            parts.push_back(part);
        }
        begin = end + 1;
    }
    std::string out = absolute ? "/" : "";
    for (size_t i = 0; i < parts.size(); ++i) {
        if (i != 0) out += '/';
        out += parts[i];
    }
    return out.empty() ? "." : out;
}

std::string join_path(std::string_view folder, std::string_view relative) {
    if (folder.empty() || (!relative.empty() && relative.front() == '/')) return normal_path(relative);
    return normal_path(std::string(folder) + "/" + std::string(relative));
}

std::string relative_path(std::string_view folder, std::string_view path) {
    if (path.empty()) return {};
    const std::filesystem::path whole = normal_path(path);
    const std::filesystem::path base = normal_path(folder.empty() ? "." : folder);
    const std::string relative = whole.lexically_relative(base).generic_string();
    return relative.empty() ? whole.generic_string() : relative;
}

std::string folder_of(std::string_view path) {
    const size_t slash = path.rfind('/');
    if (slash == std::string_view::npos) return {};
    return std::string(slash == 0 ? "/" : path.substr(0, slash));
}

}  // namespace kiln
