#include "cache/client/layered_store.h"

#include <algorithm>

#include "compiler/base/jobs.h"

namespace kiln {

namespace {

constexpr size_t most_asked_at_once = 512;
constexpr uint64_t most_bytes_at_once = uint64_t{32} << 20;

}  // namespace

LayeredStore::LayeredStore(Store& local, Has has, std::unique_ptr<RemoteCache> remote, const LayeredOptions& options)
    : local_(local),
      has_(std::move(has)),
      remote_(std::move(remote)),
      options_(options),
      queue_(
          *remote_,
          [this](const Digest& blob) -> std::optional<Bytes> {
              auto got = local_.get(Keyspace::blob, blob);
              if (!got.ok()) return std::nullopt;
              return std::move(*got);
          },
          options.queue) {}

void LayeredStore::finish() { queue_.drain(options_.drain); }

Result<std::optional<Bytes>> LayeredStore::get(Keyspace space, const Digest& key) {
    auto local = local_.get(space, key);
    if (local.ok() && local->has_value()) return local;
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = shelf_.find({space, key}); found != shelf_.end()) return std::optional<Bytes>(found->second);
        if (absent_.count({space, key}) != 0) return local;
    }
    std::optional<Bytes> got;
    if (space == Keyspace::action) {
        if (auto action = std::move(remote_->get_actions({&key, 1}).front())) got = std::move(action->record);
    } else {
        got = std::move(remote_->get_blobs({&key, 1}).front());
    }
    if (!got) {
        note_absent(space, key);
        return local;
    }
    keep(space, key, *got);
    return got;
}

Status LayeredStore::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (space == Keyspace::action) return put_record(key, bytes, {});
    const Status done = local_.put(space, key, bytes);
    if (options_.write) queue_.add_blob(key, bytes, done.ok() && local_.keeps(), known_absent(space, key));
    return done;
}

Status LayeredStore::put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) {
    const Status done = local_.put(Keyspace::action, key, record);
    if (options_.write) queue_.add_action(key, record, blobs);
    return done;
}

void LayeredStore::expect(std::span<const Digest> actions) {
    std::vector<Digest> wanted;
    std::set<Digest> seen;
    for (const Digest& key : actions)
        if (!here(Keyspace::action, key) && !known_absent(Keyspace::action, key) && seen.insert(key).second)
            wanted.push_back(key);
    std::set<Digest> fetched;
    for (size_t first = 0; first < wanted.size() && remote_->may_read() && !interrupted.load(); first += most_asked_at_once) {
        const auto keys = std::span(wanted).subspan(first, std::min(most_asked_at_once, wanted.size() - first));
        auto got = remote_->get_actions(keys);
        std::vector<Digest> blobs;
        uint64_t bytes = 0;
        const auto fetch = [&] {
            auto answers = remote_->get_blobs(blobs);
            for (size_t i = 0; i < blobs.size(); ++i)
                if (answers[i]) keep(Keyspace::blob, blobs[i], std::move(*answers[i]));
            blobs.clear();
            bytes = 0;
        };
        for (const auto& action : got) {
            if (!action) continue;
            for (const RemoteBlob& blob : action->blobs) {
                if (here(Keyspace::blob, blob.digest) || !fetched.insert(blob.digest).second) continue;
                blobs.push_back(blob.digest);
                bytes += std::min(blob.size, most_bytes_at_once);
                if (bytes >= most_bytes_at_once) fetch();
            }
        }
        if (!blobs.empty()) fetch();
        // Records after the blobs that they name, as everywhere.
        for (size_t i = 0; i < keys.size(); ++i) {
            if (got[i])
                keep(Keyspace::action, keys[i], std::move(got[i]->record));
            else
                note_absent(Keyspace::action, keys[i]);
        }
    }
}

bool LayeredStore::here(Keyspace space, const Digest& key) {
    if (has_ && has_(space, key)) return true;
    const std::lock_guard lock(mutex_);
    return shelf_.count({space, key}) != 0;
}

void LayeredStore::keep(Keyspace space, const Digest& key, Bytes bytes) {
    if (local_.keeps() && local_.put(space, key, bytes).ok()) return;
    const std::lock_guard lock(mutex_);
    if (shelved_ + bytes.size() > options_.shelf) return;
    shelved_ += bytes.size();
    shelf_.emplace(Entry{space, key}, std::move(bytes));
}

void LayeredStore::note_absent(Keyspace space, const Digest& key) {
    const std::lock_guard lock(mutex_);
    absent_.insert({space, key});
}

bool LayeredStore::known_absent(Keyspace space, const Digest& key) const {
    const std::lock_guard lock(mutex_);
    return absent_.count({space, key}) != 0;
}

}  // namespace kiln
