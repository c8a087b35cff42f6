// The store's own get() reads and hashes a whole entry in memory. A server reads the same few blobs many times and some of
// hundreds of megabytes, hence this second way in, which holds one block of a large file at a time.
#include "cache/server/blob_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace kiln {

namespace {

constexpr size_t block = 256 * 1024;
constexpr int64_t second = 1'000'000'000;
constexpr int64_t renew_after = 60 * second;  // as in disk_read.cpp: a use within a minute of the last is not written down
// Two writes within one tick of the kernel's clock leave the same change time, so a file is trusted only once it has been left
// alone for longer than a tick.
constexpr int64_t tick = second / 20;

bool read_at(int fd, uint64_t offset, std::span<uint8_t> out) {
    while (!out.empty()) {
        const ssize_t n = ::pread(fd, out.data(), out.size(), static_cast<off_t>(offset));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return false;
        if (n == 0) {
            errno = EIO;  // shorter than it was
            return false;
        }
        out = out.subspan(static_cast<size_t>(n));
        offset += static_cast<uint64_t>(n);
    }
    return true;
}

}  // namespace

BlobFile BlobFile::of(Bytes bytes) {
    BlobFile file;
    file.size_ = bytes.size();
    file.memory_ = std::make_shared<Bytes>(std::move(bytes));
    return file;
}

Status BlobFile::read(uint64_t offset, std::span<uint8_t> out) const {
    if (offset > size_ || out.size() > size_ - offset) return environment_error("cache: a read past a blob's end");
    if (fd_ == nullptr) {
        if (!out.empty()) std::copy_n(memory_->begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
        return {};
    }
    if (!read_at(fd_->get(), offset, out)) return io_error("a blob", "read", errno);
    return {};
}

Result<Bytes> BlobFile::all() const {
    Bytes bytes(static_cast<size_t>(size_));
    KILN_TRY(read(0, bytes));
    return bytes;
}

BlobReader::Identity BlobReader::identity_of(const struct stat& info) {
    return {info.st_dev, info.st_ino, static_cast<uint64_t>(info.st_size), time_of(info),
            int64_t{info.st_ctim.tv_sec} * second + info.st_ctim.tv_nsec};
}

bool BlobReader::fresh(const Verified& verified, int64_t now) const {
    return now >= verified.at && now - verified.at < again_after_ * second;
}

bool BlobReader::trusted(const Digest& key, const Identity& identity, int64_t now) {
    Shard& shard = shard_of(key);
    const std::lock_guard lock(shard.mutex);
    const auto found = shard.known.find(key);
    return found != shard.known.end() && found->second.identity == identity && fresh(found->second, now);
}

void BlobReader::trust(const Digest& key, const Identity& identity, int64_t now) {
    if (again_after_ == 0 || now - identity.changed < tick) return;
    Shard& shard = shard_of(key);
    const std::lock_guard lock(shard.mutex);
    if (shard.known.size() >= most_in_shard && !shard.known.contains(key)) {
        shard.known.clear();
        shard.kept = 0;
    }
    Verified& known = shard.known[key];
    if (known.bytes) shard.kept -= known.bytes->size();
    known = {identity, now, nullptr};
}

// When a shard is full, others' bytes go in the order of the table, which is by digest and so without regard to use. Blobs that
// are read in turn and do not all fit would each be gone before their next turn if the oldest went first.
void BlobReader::keep(const Digest& key, const std::shared_ptr<const Bytes>& bytes) {
    Shard& shard = shard_of(key);
    const std::lock_guard lock(shard.mutex);
    const auto found = shard.known.find(key);
    if (found == shard.known.end() || found->second.bytes) return;
    const size_t buckets = shard.known.bucket_count();
    for (size_t seen = 0; shard.kept + bytes->size() > most_kept / shards && seen < buckets; ++seen) {
        shard.hand = (shard.hand + 1) % buckets;
        for (auto entry = shard.known.begin(shard.hand); entry != shard.known.end(shard.hand); ++entry) {
            if (entry->second.bytes) shard.kept -= entry->second.bytes->size();
            entry->second.bytes = nullptr;
        }
    }
    found->second.bytes = bytes;
    shard.kept += bytes->size();
}

std::shared_ptr<const Bytes> BlobReader::kept_bytes(const Digest& key, const std::string& path) {
    Verified known;
    {
        Shard& shard = shard_of(key);
        const std::lock_guard lock(shard.mutex);
        const auto found = shard.known.find(key);
        if (found == shard.known.end() || !found->second.bytes) return nullptr;
        known = found->second;
    }
    struct stat info {};
    if (::lstat(path.c_str(), &info) != 0 || !(identity_of(info) == known.identity)) return nullptr;
    const int64_t now = system_time();
    return fresh(known, now) && now - time_of(info) <= renew_after ? known.bytes : nullptr;
}

uint64_t BlobReader::kept() const {
    uint64_t all = 0;
    for (const Shard& shard : shards_) {
        const std::lock_guard lock(shard.mutex);
        all += shard.kept;
    }
    return all;
}

Result<std::optional<BlobFile>> BlobReader::open(const Digest& key, bool* slow, uint64_t most) {
    static const Digest empty = sha256({});
    if (key == empty) return std::optional(BlobFile());
    const std::string path = store_.path_of(Keyspace::blob, key);
    BlobFile file;
    if (auto bytes = kept_bytes(key, path)) {
        file.size_ = bytes->size();
        file.memory_ = std::move(bytes);
        return std::optional(std::move(file));
    }
    auto fd = std::make_shared<Descriptor>(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
    if (fd->get() < 0) {
        if (errno == ENOENT || errno == ENOTDIR) return std::optional<BlobFile>();
        if (errno != ELOOP) return io_error(path, "open", errno);
    }
    struct stat info {};
    if (fd->get() >= 0 && ::fstat(fd->get(), &info) != 0) return io_error(path, "inspect", errno);
    const bool regular = fd->get() >= 0 && S_ISREG(info.st_mode);
    int64_t now = system_time();
    if (regular && now - time_of(info) > renew_after) {
        (void)set_time(fd->get(), now);  // fails where another user owns the file
        if (::fstat(fd->get(), &info) != 0) return io_error(path, "inspect", errno);
    }
    const Identity identity = identity_of(info);
    file.size_ = static_cast<uint64_t>(info.st_size);
    bool whole = regular;
    const bool known = regular && trusted(key, identity, now);
    if (regular && !known && slow != nullptr && file.size_ > most) {
        *slow = true;
        return std::optional<BlobFile>();
    }
    if (regular && file.size_ <= small) {
        auto bytes = std::make_shared<Bytes>(static_cast<size_t>(file.size_));
        if (!read_at(fd->get(), 0, *bytes)) return io_error(path, "read", errno);
        if (known) {
            keep(key, bytes);
        } else {
            ++hashed_;
            whole = sha256(*bytes) == key;
            if (whole) trust(key, identity, now);
        }
        file.memory_ = std::move(bytes);
        fd.reset();
    } else if (regular && !known) {
        ++hashed_;
        StreamHash hash;
        Bytes part(block);
        for (uint64_t at = 0; at < file.size_; at += part.size()) {
            const std::span<uint8_t> some(part.data(), static_cast<size_t>(std::min<uint64_t>(block, file.size_ - at)));
            if (!read_at(fd->get(), at, some)) return io_error(path, "read", errno);
            hash.update(some);
        }
        whole = hash.finish() == key;
        if (whole) trust(key, identity, now);
    }
    if (whole) {
        file.fd_ = std::move(fd);
        return std::optional(std::move(file));
    }
    // Damaged: the store reads it again, sets it aside and counts it. Where another writer has put it right meanwhile, the
    // good bytes come back.
    auto again = store_.get(Keyspace::blob, key);
    if (!again.ok()) return again.error();
    if (!again->has_value()) return std::optional<BlobFile>();
    return std::optional(BlobFile::of(std::move(**again)));
}

Result<bool> BlobReader::has(const Digest& key, uint64_t size) {
    static const Digest empty = sha256({});
    if (key == empty) return size == 0;
    const auto found = store_.find(Keyspace::blob, key);
    if (!found.ok()) return found.error();
    return found->has_value() && **found == size;
}

}  // namespace kiln
