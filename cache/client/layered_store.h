#pragma once
// The store of a build with a server: the local store first, then the server, whose hits are kept locally. What is put goes to
// the local store at once and to the server later. The server never makes a call fail (remote_cache.h).

#include <set>

#include "cache/client/upload_queue.h"
#include "compiler/base/store.h"

namespace kiln {

struct LayeredOptions {
    bool write = true;                        // false: nothing is sent
    uint64_t shelf = uint64_t{64} << 20;      // bytes of hits that the local store does not keep
    std::chrono::milliseconds drain{30'000};  // how long finish() waits for uploads
    UploadQueue::Limits queue;
};

class LayeredStore final : public Store {
public:
    // Whether the local store seems to have an entry, without reading it.
    using Has = std::function<bool(Keyspace space, const Digest& key)>;

    // `local` outlives this object; it may be one that keeps nothing.
    LayeredStore(Store& local, Has has, std::unique_ptr<RemoteCache> remote, const LayeredOptions& options);
    ~LayeredStore() override { finish(); }

    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override;
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;
    Status put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) override;
    // Fetches those actions that are not here and the blobs that they name.
    void expect(std::span<const Digest> actions) override;

    // Ends the uploads within their time. Nothing may be put afterwards.
    void finish();
    const RemoteCache& remote() const { return *remote_; }

private:
    using Entry = std::pair<Keyspace, Digest>;
    void keep(Keyspace space, const Digest& key, Bytes bytes);
    bool here(Keyspace space, const Digest& key);
    void note_absent(Keyspace space, const Digest& key);
    bool known_absent(Keyspace space, const Digest& key) const;

    Store& local_;
    const Has has_;
    const std::unique_ptr<RemoteCache> remote_;
    const LayeredOptions options_;
    UploadQueue queue_;
    mutable std::mutex mutex_;
    std::map<Entry, Bytes> shelf_;
    uint64_t shelved_ = 0;
    std::set<Entry> absent_;  // the server has said so in this run
};

}  // namespace kiln
