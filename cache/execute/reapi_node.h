#pragma once
// A node of an engine: what it can do, and one execution on it from its start to its end. Included by the gRPC module's sources
// alone.

#include <operations.grpc.pb.h>

#include <mutex>

#include "cache/execute/reapi_action.h"
#include "cache/execute/reapi_engine.h"

namespace kiln {

// What became of an attempt.
struct Outcome {
    enum class Kind { done, failed, no_node, missing };
    Kind kind = Kind::failed;
    std::string problem;
    reapi::ExecuteResponse response;  // done
};

class ReapiNode {
public:
    using Clock = std::chrono::steady_clock;

    static Result<std::unique_ptr<ReapiNode>> open(const RemoteUrl& url, const ReapiOptions& options);

    // What it lacks of the action's blobs is sent; `whatever_it_says`: all of them. What jobs share (the worker) is sent by the
    // first.
    Outcome send(const ReapiAction& action, bool whatever_it_says);
    // Follows the operation until it has ended; `anew`: not from the engine's cache. One that nobody waits for any more, at `end`
    // or after an interruption, is cancelled.
    Outcome execute(const BlobName& action, bool anew, Clock::time_point end);

    bool interrupted() const { return options_.remote.interrupted != nullptr && options_.remote.interrupted->load(); }
    bool rests() const { return Clock::now().time_since_epoch().count() < rests_until_; }
    void rest() { rests_until_ = (Clock::now() + options_.rest).time_since_epoch().count(); }

    const RemoteUrl url;
    RemoteStore& blobs() { return *blobs_; }

private:
    class Watch;
    ReapiNode(const RemoteUrl& address, const ReapiOptions& options);
    std::optional<Outcome> refusal();
    Outcome deliver(const ReapiAction& action, bool whatever_it_says);
    void cancel(const std::string& operation);
    void silent() { silent_until_ = (Clock::now() + options_.rest).time_since_epoch().count(); }

    const ReapiOptions options_;
    const std::string instance_;
    std::unique_ptr<reapi::Capabilities::Stub> capabilities_;
    std::unique_ptr<reapi::Execution::Stub> execution_;
    std::unique_ptr<google::longrunning::Operations::Stub> operations_;
    std::unique_ptr<RemoteStore> blobs_;
    std::mutex sending_;
    bool executes_ = false;  // has said so, or says nothing of it; under sending_
    std::atomic<Clock::rep> rests_until_{0}, silent_until_{0};
};

}  // namespace kiln
