#pragma once
// One lock for a store's folder, among its threads (a mutex) and all processes (a file's lock, which a killed process drops).
// Held for moments: to account for an entry and name it, to evict, to quarantine. Reads take no lock.

#include <chrono>
#include <mutex>
#include <string>

#include "compiler/base/result.h"

namespace kiln {

class FolderLock {
public:
    class Hold {
    public:
        Hold(std::unique_lock<std::mutex> threads, int fd) : threads_(std::move(threads)), fd_(fd) {}
        Hold(Hold&& other) noexcept : threads_(std::move(other.threads_)), fd_(std::exchange(other.fd_, -1)) {}
        Hold& operator=(Hold&&) = delete;
        ~Hold();
        // False where the file system has no locks: other processes are not kept out.
        bool among_processes() const { return fd_ >= 0; }

    private:
        std::unique_lock<std::mutex> threads_;
        int fd_;
    };

    FolderLock(std::string path, std::chrono::milliseconds wait) : path_(std::move(path)), wait_(wait) {}
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    ~FolderLock();

    // An Error when the lock's file cannot be opened or another process keeps it longer than `wait`; after that, at once for a
    // minute, so that a stopped process costs a build one wait and not one an entry.
    Result<Hold> take();

private:
    Status open_file();

    const std::string path_;
    const std::chrono::milliseconds wait_;
    std::mutex threads_;
    int fd_ = -1;
    std::chrono::steady_clock::time_point refused_until_{};
};

}  // namespace kiln
