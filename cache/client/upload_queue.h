#pragma once
// Sends what a build makes to the server while the build goes on. Nothing waits for it until drain(), and it holds a bounded
// number of bytes: past that, bytes are read back from the local store when their turn comes, or not sent.
//
// An action goes only after the server has every blob that it names.

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "cache/client/remote_cache.h"

namespace kiln {

class UploadQueue {
public:
    // A blob's bytes from the local store, where it has them.
    using Load = std::function<std::optional<Bytes>(const Digest& blob)>;
    struct Limits {
        uint64_t bytes = uint64_t{64} << 20;
        size_t entries = 1'000'000;
    };

    // `remote` outlives this object.
    UploadQueue(RemoteCache& remote, Load load, Limits limits) : remote_(remote), load_(std::move(load)), limits_(limits) {}
    ~UploadQueue();

    // `kept`: the local store has it as well. `missing`: the server has just said that it has not.
    void add_blob(const Digest& name, ByteView bytes, bool kept, bool missing);
    void add_action(const Digest& key, ByteView record, std::span<const Digest> blobs);
    // Waits until everything is sent or `patience` is over; what is left then is not sent. Nothing may be added afterwards.
    void drain(std::chrono::milliseconds patience);

private:
    struct Entry {
        bool action = false;
        Digest key;
        Bytes bytes;
        bool loaded = true;  // false: to be read from the local store
        bool missing = false;
        std::vector<Digest> blobs;
    };
    void add(Entry entry);
    void loop();
    void send(std::vector<Entry> batch);
    void send_blobs(std::vector<Entry>& batch);
    bool all_there(Entry& action, std::vector<RemoteBlob>& blobs);

    RemoteCache& remote_;
    const Load load_;
    const Limits limits_;
    std::map<Digest, uint64_t> there_;  // blobs on the server and their sizes; the thread's own, as is the next
    std::set<Digest> failed_;           // blobs that could not be sent
    std::mutex mutex_;
    std::condition_variable wake_, idle_;
    std::deque<Entry> entries_;
    uint64_t bytes_ = 0;
    bool busy_ = false, ending_ = false;
    std::thread thread_;
};

}  // namespace kiln
