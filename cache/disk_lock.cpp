// Two bytes of one file are locked, by open file descriptions (F_OFD_SETLK). Byte 0 is the lock. Byte 1 is held while waiting for
// it: who has just given the lock back and wants it again finds byte 1 taken, so that nobody is starved by another's loop.
//
// The file may be removed with its folder while it is open. Then a lock on it excludes nobody who came later, so after each
// lock the name is compared with what is locked.
#include "cache/disk_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <thread>

#include "cache/disk_folder.h"

namespace kiln {

namespace {

using std::chrono::steady_clock;

bool is_at(int fd, const std::string& path) {
    struct stat open {
    }, named{};
    return ::fstat(fd, &open) == 0 && ::stat(path.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
}

constexpr off_t the_lock = 0, the_turn = 1;

bool set_lock(int fd, off_t byte, short type) {
    struct flock range {};
    range.l_type = type;
    range.l_whence = SEEK_SET;
    range.l_start = byte;
    range.l_len = 1;
    return ::fcntl(fd, F_OFD_SETLK, &range) == 0;
}

// 0, or the errno.
int lock_until(int fd, off_t byte, steady_clock::time_point deadline) {
    auto pause = std::chrono::microseconds(20);
    while (!set_lock(fd, byte, F_WRLCK)) {
        if (errno == EINTR) continue;
        if (errno != EAGAIN && errno != EACCES) return errno;
        if (steady_clock::now() >= deadline) return EWOULDBLOCK;
        std::this_thread::sleep_for(pause);
        pause = std::min(pause * 2, std::chrono::microseconds(500));
    }
    return 0;
}

}  // namespace

FolderLock::Hold::~Hold() {
    if (fd_ >= 0) set_lock(fd_, the_lock, F_UNLCK);
}

FolderLock::~FolderLock() {
    if (fd_ >= 0) ::close(fd_);
}

Status FolderLock::open_file() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd_ < 0 && errno == ENOENT) {
        std::error_code failed;
        std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), failed);
        fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    }
    return fd_ >= 0 ? Status() : io_error(path_, "open", errno);
}

Result<FolderLock::Hold> FolderLock::take() {
    std::unique_lock threads(threads_);
    const auto start = steady_clock::now();
    if (start < refused_until_) return io_error(path_, "lock", EWOULDBLOCK);
    for (;;) {
        if (fd_ < 0) KILN_TRY(open_file());
        int code = lock_until(fd_, the_turn, start + wait_);
        if (code == 0) {
            code = lock_until(fd_, the_lock, start + wait_);
            set_lock(fd_, the_turn, F_UNLCK);
        }
        if (code == EWOULDBLOCK) {
            refused_until_ = steady_clock::now() + std::chrono::minutes(1);
            return io_error(path_, "lock", code);
        }
        if (code != 0) return Hold(std::move(threads), -1);
        if (is_at(fd_, path_)) return Hold(std::move(threads), fd_);
        ::close(fd_);
        fd_ = -1;
    }
}

}  // namespace kiln
