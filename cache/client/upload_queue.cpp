#include "cache/client/upload_queue.h"

#include <algorithm>

#include "compiler/base/jobs.h"

namespace kiln {

namespace {

constexpr size_t most_in_batch = 128;
constexpr uint64_t most_bytes_in_batch = 3'000'000;

}  // namespace

UploadQueue::~UploadQueue() { drain(std::chrono::milliseconds(0)); }

void UploadQueue::add_blob(const Digest& name, ByteView bytes, bool kept, bool missing) {
    Entry entry;
    entry.key = name;
    entry.missing = missing;
    {
        const std::lock_guard lock(mutex_);
        const bool room = bytes_ + bytes.size() <= limits_.bytes;
        entry.loaded = room;
        if (!room && !kept) {
            remote_.count_not_sent(1);
            return;
        }
    }
    if (entry.loaded) entry.bytes.assign(bytes.begin(), bytes.end());
    add(std::move(entry));
}

void UploadQueue::add_action(const Digest& key, ByteView record, std::span<const Digest> blobs) {
    Entry entry;
    entry.action = true;
    entry.key = key;
    entry.bytes.assign(record.begin(), record.end());
    entry.blobs.assign(blobs.begin(), blobs.end());
    add(std::move(entry));
}

void UploadQueue::add(Entry entry) {
    const std::lock_guard lock(mutex_);
    if (ending_ || !remote_.may_write() || entries_.size() >= limits_.entries ||
        bytes_ + entry.bytes.size() > 2 * limits_.bytes) {
        remote_.count_not_sent(1);
        return;
    }
    bytes_ += entry.bytes.size();
    entries_.push_back(std::move(entry));
    if (!thread_.joinable()) thread_ = std::thread([this] { loop(); });
    wake_.notify_one();
}

void UploadQueue::drain(std::chrono::milliseconds patience) {
    {
        std::unique_lock lock(mutex_);
        const auto until = std::chrono::steady_clock::now() + patience;
        while (!interrupted.load() && (busy_ || !entries_.empty()) && std::chrono::steady_clock::now() < until)
            idle_.wait_until(lock, std::min(until, std::chrono::steady_clock::now() + std::chrono::milliseconds(100)));
        ending_ = true;
        if (!entries_.empty()) remote_.count_not_sent(entries_.size());
        entries_.clear();
        bytes_ = 0;
        if (busy_) remote_.end_at(std::chrono::steady_clock::now());
        wake_.notify_one();
    }
    if (thread_.joinable()) thread_.join();
}

void UploadQueue::loop() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return ending_ || !entries_.empty(); });
        if (entries_.empty()) return;
        std::vector<Entry> batch;
        uint64_t bytes = 0;
        while (!entries_.empty() && batch.size() < most_in_batch && bytes < most_bytes_in_batch) {
            bytes += entries_.front().bytes.size();
            batch.push_back(std::move(entries_.front()));
            entries_.pop_front();
        }
        busy_ = true;
        lock.unlock();
        if (remote_.may_write())
            send(std::move(batch));
        else
            remote_.count_not_sent(batch.size());
        lock.lock();
        busy_ = false;
        bytes_ -= std::min(bytes, bytes_);
        idle_.notify_all();
    }
}

void UploadQueue::send(std::vector<Entry> batch) {
    send_blobs(batch);
    std::vector<RemoteCache::ActionSending> actions;
    for (Entry& entry : batch) {
        if (!entry.action) continue;
        std::vector<RemoteBlob> blobs;
        if (all_there(entry, blobs))
            actions.push_back({entry.key, entry.bytes, std::move(blobs)});
        else
            remote_.count_not_sent(1);
    }
    remote_.put_actions(actions);
}

void UploadQueue::send_blobs(std::vector<Entry>& batch) {
    std::vector<RemoteCache::Sending> blobs;
    std::set<Digest> named;
    for (Entry& entry : batch) {
        if (entry.action || there_.count(entry.key) != 0 || !named.insert(entry.key).second) continue;
        if (!entry.loaded) {
            std::optional<Bytes> bytes = load_ ? load_(entry.key) : std::nullopt;
            if (!bytes) {
                remote_.count_not_sent(1);
                failed_.insert(entry.key);
                continue;
            }
            entry.bytes = std::move(*bytes);
            entry.loaded = true;
        }
        blobs.push_back({entry.key, entry.bytes, entry.missing});
    }
    if (blobs.empty()) return;
    const std::vector<bool> done = remote_.put_blobs(blobs);
    for (size_t i = 0; i < blobs.size(); ++i)
        if (done[i])
            there_[blobs[i].key] = blobs[i].bytes.size();
        else
            failed_.insert(blobs[i].key);
}

// Blobs that an earlier build made are in the local store alone, and go now.
bool UploadQueue::all_there(Entry& action, std::vector<RemoteBlob>& blobs) {
    for (const Digest& name : action.blobs) {
        if (there_.count(name) == 0) {
            const std::optional<Bytes> bytes = load_ && failed_.count(name) == 0 ? load_(name) : std::nullopt;
            if (!bytes) return false;
            const RemoteCache::Sending sending{name, *bytes, false};
            if (!remote_.put_blobs({&sending, 1}).front()) {
                failed_.insert(name);
                return false;
            }
            there_[name] = bytes->size();
        }
        blobs.push_back({name, there_[name]});
    }
    return true;
}

}  // namespace kiln
