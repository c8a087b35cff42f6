#pragma once
// A server as seen by a build: what comes back is verified here, failures are counted apart from misses, and a server that
// fails is left alone (breaker.h). No call returns an Error: without the server a build takes longer, and that is all.

#include <atomic>
#include <map>
#include <mutex>
#include <optional>

#include "cache/client/breaker.h"
#include "cache/client/remote_record.h"
#include "cache/client/remote_store.h"

namespace kiln {

struct RemoteCounters {
    uint64_t hits = 0, misses = 0;  // of actions and blobs asked
    uint64_t failures = 0;          // requests of any kind that failed
    uint64_t corrupt = 0;           // answers that were not what was asked for; also counted as misses
    uint64_t untrusted = 0;         // records without a good signature, where one is asked for; also misses
    uint64_t not_asked = 0;         // while the server was left alone
    uint64_t bytes_in = 0, bytes_out = 0;
    uint64_t sent = 0, already_there = 0;
    uint64_t kept_first = 0;  // actions that the server holds with other bytes
    uint64_t not_sent = 0;    // out of time or room, or after a failure
    bool may_not_read = false, may_not_write = false;
    std::string problem;  // the first one
};

class RemoteCache {
public:
    // `signer` and `verifier` may be null.
    RemoteCache(std::unique_ptr<RemoteStore> remote, Breaker::Rules rules, const RemoteLimits& limits,
                std::unique_ptr<Signer> signer, std::unique_ptr<Verifier> verifier);

    struct Action {
        Bytes record;
        std::vector<RemoteBlob> blobs;
    };
    // In the order asked; nullopt: not there, not right or not to be had.
    std::vector<std::optional<Action>> get_actions(std::span<const Digest> keys);
    // A size that an action once told is known here.
    std::vector<std::optional<Bytes>> get_blobs(std::span<const Digest> names);

    struct Sending {
        Digest key;
        ByteView bytes;
        bool surely_missing = false;  // no need to ask
    };
    // Blobs that are not there are sent. True for each that is there afterwards.
    std::vector<bool> put_blobs(std::span<const Sending> blobs);
    struct ActionSending {
        Digest key;
        ByteView record;
        std::vector<RemoteBlob> blobs;
    };
    void put_actions(std::span<const ActionSending> actions);
    void count_not_sent(uint64_t n);

    bool may_read() const { return !may_not_read_; }
    bool may_write() const { return !may_not_write_; }
    std::string name() const { return remote_->name(); }
    RemoteCounters counters() const;
    void end_at(std::chrono::steady_clock::time_point when) { remote_->end_at(when); }

private:
    enum class Doing { reading, writing };
    bool may_ask(size_t requests, Doing doing);
    // True for found. Counts everything but hits and misses. Of what was read, the breaker is told once it proves right.
    bool judge(const RemoteAnswer& answer, Doing doing);
    void corrupt(const Digest& key, const char* what);
    std::optional<Action> read_action(const Digest& key, RemoteAnswer& answer, std::optional<RemoteBlob>& frame_blob);

    const std::unique_ptr<RemoteStore> remote_;
    const RemoteLimits limits_;
    const std::unique_ptr<Signer> signer_;
    const std::unique_ptr<Verifier> verifier_;
    Breaker breaker_;
    std::atomic<bool> may_not_read_{false}, may_not_write_{false};
    mutable std::mutex mutex_;  // the counters and the sizes
    RemoteCounters counters_;
    std::map<Digest, uint64_t> sizes_;
};

}  // namespace kiln
