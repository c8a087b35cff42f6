#pragma once
// A server in memory that does as it is told.

#include <functional>
#include <map>
#include <mutex>

#include "cache/client/remote_store.h"

namespace kiln {

class FakeRemote final : public RemoteStore {
public:
    struct Shared {
        std::mutex mutex;
        std::map<Digest, Bytes> actions, blobs;
        std::vector<std::string> calls;  // "get_actions 3"
        // Changes an answer before it is given.
        std::function<void(const char* call, const Digest& key, RemoteAnswer& answer)> meddle;
    };
    explicit FakeRemote(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}

    std::string name() const override { return "fake://"; }
    std::vector<RemoteAnswer> get_actions(std::span<const Digest> keys) override {
        return each("get_actions", keys, [&](const Digest& key) { return look(shared_->actions, key, true); });
    }
    std::vector<RemoteAnswer> get_blobs(std::span<const RemoteBlob> blobs) override {
        return each("get_blobs", names(blobs), [&](const Digest& key) { return look(shared_->blobs, key, true); });
    }
    std::vector<RemoteAnswer> find_blobs(std::span<const RemoteBlob> blobs) override {
        return each("find_blobs", names(blobs), [&](const Digest& key) { return look(shared_->blobs, key, false); });
    }
    std::vector<RemoteAnswer> put_blobs(std::span<const RemoteUpload> blobs) override {
        return put("put_blobs", shared_->blobs, blobs);
    }
    std::vector<RemoteAnswer> put_actions(std::span<const RemoteUpload> actions) override {
        return put("put_actions", shared_->actions, actions);
    }
    void end_at(std::chrono::steady_clock::time_point) override {}

private:
    static std::vector<Digest> names(std::span<const RemoteBlob> blobs) {
        std::vector<Digest> out;
        for (const RemoteBlob& blob : blobs) out.push_back(blob.digest);
        return out;
    }
    static RemoteAnswer look(const std::map<Digest, Bytes>& map, const Digest& key, bool read) {
        const auto at = map.find(key);
        if (at == map.end()) return {RemoteAnswer::Kind::absent, {}, {}, false};
        return {RemoteAnswer::Kind::found, read ? at->second : Bytes(), {}, false};
    }
    template <class Look>
    std::vector<RemoteAnswer> each(const char* call, std::span<const Digest> keys, Look look_up) {
        const std::lock_guard lock(shared_->mutex);
        shared_->calls.push_back(std::string(call) + " " + std::to_string(keys.size()));
        std::vector<RemoteAnswer> answers;
        for (const Digest& key : keys) {
            answers.push_back(look_up(key));
            if (shared_->meddle) shared_->meddle(call, key, answers.back());
        }
        return answers;
    }
    std::vector<RemoteAnswer> put(const char* call, std::map<Digest, Bytes>& map, std::span<const RemoteUpload> uploads) {
        std::vector<Digest> keys;
        for (const RemoteUpload& upload : uploads) keys.push_back(upload.key);
        size_t i = 0;
        return each(call, keys, [&](const Digest& key) {
            RemoteAnswer answer{RemoteAnswer::Kind::found, {}, {}, false};
            if (shared_->meddle) shared_->meddle(call, key, answer);
            const ByteView bytes = uploads[i++].bytes;
            if (answer.kind == RemoteAnswer::Kind::found) map[key] = Bytes(bytes.begin(), bytes.end());
            return answer;
        });
    }
    const std::shared_ptr<Shared> shared_;
};

}  // namespace kiln
