#pragma once
// A server that hurts its user (--chaos): answers vanish, fail, take long, and arrive with a bit flipped; writes are lost. From a
// seed, as chaos_store.h has it.

#include <atomic>
#include <memory>

#include "cache/chaos_store.h"
#include "cache/client/remote_store.h"

namespace kiln {

class ChaosRemote final : public RemoteStore {
public:
    ChaosRemote(std::unique_ptr<RemoteStore> inner, const Chaos& chaos) : inner_(std::move(inner)), chaos_(chaos) {}

    std::string name() const override { return inner_->name(); }
    std::vector<RemoteAnswer> get_actions(std::span<const Digest> keys) override;
    std::vector<RemoteAnswer> get_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> find_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> put_blobs(std::span<const RemoteUpload> blobs) override;
    std::vector<RemoteAnswer> put_actions(std::span<const RemoteUpload> actions) override;
    void end_at(std::chrono::steady_clock::time_point when) override { inner_->end_at(when); }
    ChaosStore::Counters counters() const { return {lost_.load(), failed_.load(), flipped_.load(), delayed_.load()}; }

private:
    enum class Call : uint8_t { get_action, get_blob, find, put_blob, put_action };
    // False: the answer stays as it was.
    bool hurt(Call call, const Digest& key, RemoteAnswer& answer);

    const std::unique_ptr<RemoteStore> inner_;
    const Chaos chaos_;
    std::atomic<uint64_t> lost_{0}, failed_{0}, flipped_{0}, delayed_{0};
};

}  // namespace kiln
