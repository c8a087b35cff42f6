#include "cache/execute/reapi_engine.h"

#include <algorithm>

#include "cache/client/grpc_calls.h"
#include "cache/execute/reapi_action.h"
#include "cache/protocol/action_result.h"

kiln::OpenGrpcRemote kiln_grpc_open_2 __asm__("kiln_grpc_open_2");

namespace kiln {

namespace {

using google::longrunning::Operation;
using Clock = std::chrono::steady_clock;

constexpr int most_tries = 5;  // streams opened for one action

// An engine's words for a person: one line, without what a terminal would obey.
std::string words(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 400)) out += c >= ' ' && c <= '~' ? c : ' ';
    return out;
}

// Follows the stream of one Execute or WaitExecution.
class Watch final : public grpc::ClientReadReactor<Operation> {
public:
    template <class Open>
    Watch(const std::string& token, Clock::time_point end, const Open& open) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
        context_.set_deadline(std::chrono::system_clock::now() + left);
        if (!token.empty()) context_.AddMetadata("authorization", "Bearer " + token);
        open(&context_, this);
        StartRead(&next_);
        StartCall();
    }
    void OnReadDone(bool ok) override {
        if (!ok) return;
        last = std::move(next_);
        next_.Clear();
        if (last.done()) return context_.TryCancel();  // nothing that may follow is of interest
        StartRead(&next_);
    }
    void OnDone(const grpc::Status& how) override {
        const std::lock_guard lock(mutex_);
        status = how;
        over_ = true;
        wake_.notify_one();
    }
    void wait(const std::atomic<bool>* interrupted) {
        std::unique_lock lock(mutex_);
        while (!over_) {
            if (interrupted != nullptr && interrupted->load()) context_.TryCancel();
            wake_.wait_for(lock, std::chrono::milliseconds(50));
        }
    }

    Operation last;  // the newest that came
    grpc::Status status;

private:
    grpc::ClientContext context_;
    Operation next_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool over_ = false;
};

// What became of an attempt.
struct Outcome {
    enum class Kind { done, failed, no_node, missing };
    Kind kind = Kind::failed;
    std::string problem;
    reapi::ExecuteResponse response;  // done
};

struct Node {
    Node(const RemoteUrl& address, const ReapiOptions& options)
        : url(address),
          instance(address.path.empty() ? "" : address.path.substr(1)),
          execution(reapi::Execution::NewStub(open_grpc_channel(address, options.remote))) {}

    const RemoteUrl url;
    const std::string instance;
    const std::unique_ptr<reapi::Execution::Stub> execution;
    std::unique_ptr<RemoteStore> blobs;
    std::mutex sending;  // what jobs share (the worker) is sent by the first of them
    std::atomic<Clock::rep> rests_until{0};
};

Outcome outcome_of(int code, const std::string& message) {
    switch (static_cast<grpc::StatusCode>(code)) {
        case grpc::StatusCode::OK:
            return {Outcome::Kind::done, {}, {}};
        case grpc::StatusCode::FAILED_PRECONDITION:
            return {Outcome::Kind::missing, "it misses what it was sent", {}};
        case grpc::StatusCode::UNAVAILABLE:
            return {Outcome::Kind::no_node, "it cannot be reached or went away", {}};
        case grpc::StatusCode::DEADLINE_EXCEEDED:
            return {Outcome::Kind::failed, "it did not end in time", {}};
        case grpc::StatusCode::UNIMPLEMENTED:
            return {Outcome::Kind::failed, "it does not execute", {}};
        case grpc::StatusCode::UNAUTHENTICATED:
        case grpc::StatusCode::PERMISSION_DENIED:
            return {Outcome::Kind::failed, "this token may not execute", {}};
        default:
            return {Outcome::Kind::failed, "it answered gRPC status " + std::to_string(code) + ": " + words(message), {}};
    }
}

class ReapiEngine final : public Engine {
public:
    explicit ReapiEngine(ReapiOptions options) : options_(std::move(options)) {}
    Status add(const RemoteUrl& url) {
        nodes_.push_back(std::make_unique<Node>(url, options_));
        GrpcRemoteOptions remote = options_.remote;
        remote.inputs = true;
        RemoteLimits limits;
        limits.blob = largest_output;
        auto blobs = kiln_grpc_open_2(url, remote, limits);
        KILN_TRY(blobs);
        nodes_.back()->blobs = std::move(*blobs);
        return {};
    }

    std::string name() const override {
        return nodes_.front()->url.text() + (nodes_.size() == 1 ? "" : " and " + std::to_string(nodes_.size() - 1) + " more");
    }
    size_t width() const override { return options_.width * nodes_.size(); }
    Result<JobResult> run(const Job& job, std::chrono::milliseconds deadline) override;

private:
    Result<JobResult> run_on(Node& node, const Job& job, const ReapiAction& action, Clock::time_point end, bool& reached);
    Outcome send(Node& node, const ReapiAction& action, bool whatever_it_says);
    Outcome execute(Node& node, const ReapiAction& action, bool anew, Clock::time_point end);
    Outcome fetch(Node& node, const Job& job, const ActionResult& result, JobResult& out);
    // What a command that failed wrote to its standard error, as far as it is to be had.
    static std::string complaint(Node& node, const ActionResult& result);

    const ReapiOptions options_;
    std::vector<std::unique_ptr<Node>> nodes_;
    std::atomic<size_t> turn_{0};
};

// A node that was left alone is asked again when there is no other.
Result<JobResult> ReapiEngine::run(const Job& job, std::chrono::milliseconds deadline) {
    const auto end = Clock::now() + deadline;
    const auto action = reapi_action(job, options_.platform);
    KILN_TRY(action);
    std::vector<Node*> order;
    const size_t first = turn_++;
    for (size_t i = 0; i < nodes_.size(); ++i) order.push_back(nodes_[(first + i) % nodes_.size()].get());
    const Clock::rep now = Clock::now().time_since_epoch().count();
    std::stable_partition(order.begin(), order.end(), [&](const Node* node) { return node->rests_until <= now; });
    std::optional<Error> problem;
    for (Node* node : order) {
        if (problem && Clock::now() >= end) break;
        bool reached = true;
        auto result = run_on(*node, job, *action, end, reached);
        if (reached) return result;
        node->rests_until = (Clock::now() + options_.rest).time_since_epoch().count();
        problem = result.error();
    }
    return *problem;
}

Result<JobResult> ReapiEngine::run_on(Node& node, const Job& job, const ReapiAction& action, Clock::time_point end,
                                      bool& reached) {
    const auto error = [&](const Outcome& outcome) {
        reached = outcome.kind != Outcome::Kind::no_node;
        return environment_error(node.url.text() + ": " + outcome.problem);
    };
    bool sent_again = false, anew = false;
    Outcome outcome = send(node, action, false);
    while (outcome.kind == Outcome::Kind::done) {
        outcome = execute(node, action, anew, end);
        if (outcome.kind == Outcome::Kind::missing && !sent_again) {
            sent_again = true;
            outcome = send(node, action, true);
            continue;
        }
        if (outcome.kind != Outcome::Kind::done) break;
        const std::string bytes = outcome.response.result().SerializeAsString();
        const auto result = parse_action_result(as_bytes(bytes));
        if (!result.ok()) return error({Outcome::Kind::failed, "its result is malformed: " + words(result.error().message), {}});
        if (result->exit_code != 0)
            return error({Outcome::Kind::failed,
                          "the command ended with " + std::to_string(result->exit_code) + ": " + complaint(node, *result),
                          {}});
        JobResult out;
        out.cached = outcome.response.cached_result();
        outcome = fetch(node, job, *result, out);
        if (outcome.kind == Outcome::Kind::done) return out;
        if (outcome.kind != Outcome::Kind::missing || anew || !out.cached) break;
        anew = true;  // a result that the engine remembers, but whose files are gone
        outcome.kind = Outcome::Kind::done;
    }
    return error(outcome);
}

// Sends what the node says it lacks; `whatever_it_says`: everything.
Outcome ReapiEngine::send(Node& node, const ReapiAction& action, bool whatever_it_says) {
    const std::lock_guard lock(node.sending);
    const auto trouble = [](const RemoteAnswer& answer) {
        return Outcome{
            answer.kind == RemoteAnswer::Kind::denied ? Outcome::Kind::failed : Outcome::Kind::no_node, answer.problem, {}};
    };
    std::vector<RemoteBlob> all;
    for (const auto& [digest, bytes] : action.blobs) all.push_back({digest, bytes.size()});
    std::vector<RemoteUpload> lacking;
    if (whatever_it_says) {
        for (const auto& [digest, bytes] : action.blobs) lacking.push_back({digest, bytes});
    } else {
        const auto found = node.blobs->find_blobs(all);
        for (size_t i = 0; i < all.size(); ++i) {
            if (found[i].kind == RemoteAnswer::Kind::found) continue;
            if (found[i].kind != RemoteAnswer::Kind::absent) return trouble(found[i]);
            lacking.push_back({all[i].digest, action.blobs.at(all[i].digest)});
        }
    }
    if (!lacking.empty())
        for (const RemoteAnswer& answer : node.blobs->put_blobs(lacking))
            if (answer.kind != RemoteAnswer::Kind::found) return trouble(answer);
    return {Outcome::Kind::done, {}, {}};
}

Outcome ReapiEngine::execute(Node& node, const ReapiAction& action, bool anew, Clock::time_point end) {
    reapi::ExecuteRequest request;
    request.set_instance_name(node.instance);
    request.set_skip_cache_lookup(anew);
    set_digest(request.mutable_action_digest(), action.name);
    std::string operation;
    Outcome outcome;
    for (int tries = 0; tries < most_tries; ++tries) {
        if (Clock::now() >= end) return {Outcome::Kind::failed, "it did not end in time", {}};
        reapi::WaitExecutionRequest waiting;
        waiting.set_name(operation);
        Watch watch(options_.remote.token, end, [&](grpc::ClientContext* context, grpc::ClientReadReactor<Operation>* reactor) {
            if (operation.empty())
                node.execution->async()->Execute(context, &request, reactor);
            else
                node.execution->async()->WaitExecution(context, &waiting, reactor);
        });
        watch.wait(options_.remote.interrupted);
        const Operation& said = watch.last;
        if (said.done()) {
            if (said.has_error()) return outcome_of(std::max(said.error().code(), 1), said.error().message());
            if (!said.has_response() || !said.response().UnpackTo(&outcome.response))
                return {Outcome::Kind::failed, "its answer is malformed", {}};
            const Outcome how = outcome_of(outcome.response.status().code(), outcome.response.status().message());
            outcome.kind = how.kind;
            outcome.problem = how.problem;
            if (how.kind == Outcome::Kind::done && !outcome.response.has_result())
                return {Outcome::Kind::failed, "its answer holds no result", {}};
            return outcome;
        }
        outcome = outcome_of(watch.status.error_code(), watch.status.error_message());
        if (outcome.kind == Outcome::Kind::done) outcome = {Outcome::Kind::no_node, "it ended without an answer", {}};
        const bool forgotten = !operation.empty() && watch.status.error_code() == grpc::StatusCode::NOT_FOUND;
        if (forgotten) {
            operation.clear();  // the node was started again
        } else {
            if (outcome.kind != Outcome::Kind::no_node) return outcome;
            if (!said.name().empty()) operation = said.name();
            if (operation.empty()) return outcome;  // it was never taken: another node may
        }
    }
    return outcome;
}

std::string ReapiEngine::complaint(Node& node, const ActionResult& result) {
    if (!result.stderr_raw.empty() || !result.stderr_digest || result.stderr_digest->size > 64 * 1024)
        return words(as_text(result.stderr_raw));
    const RemoteBlob blob{result.stderr_digest->digest, result.stderr_digest->size};
    return words(as_text(node.blobs->get_blobs({&blob, 1}).front().bytes));
}

Outcome ReapiEngine::fetch(Node& node, const Job& job, const ActionResult& result, JobResult& out) {
    const auto hostile = [](const std::string& what) { return Outcome{Outcome::Kind::failed, what, {}}; };
    std::map<std::string, const ActionResult::File*> files;
    for (const ActionResult::File& file : result.files) {
        if (!stays_below(file.path)) return hostile("its result has a path outside the job's folder");
        files.emplace(file.path, &file);
    }
    std::vector<RemoteBlob> wanted;
    std::vector<size_t> places;
    out.outputs.resize(job.outputs.size());
    for (size_t i = 0; i < job.outputs.size(); ++i) {
        const auto found = files.find(job.outputs[i]);
        if (found == files.end()) return hostile("its result lacks " + job.outputs[i]);
        const ActionResult::File& file = *found->second;
        if (file.blob.size > largest_output) return hostile("its " + job.outputs[i] + " is too large");
        if (file.contents.size() == file.blob.size && sha256(file.contents) == file.blob.digest) {
            out.outputs[i] = file.contents;
            continue;
        }
        wanted.push_back({file.blob.digest, file.blob.size});
        places.push_back(i);
    }
    if (wanted.empty()) return {Outcome::Kind::done, {}, {}};
    std::vector<RemoteAnswer> answers = node.blobs->get_blobs(wanted);
    for (size_t i = 0; i < answers.size(); ++i) {
        const std::string& path = job.outputs[places[i]];
        if (answers[i].kind == RemoteAnswer::Kind::absent) return {Outcome::Kind::missing, "it lost " + path, {}};
        if (answers[i].kind == RemoteAnswer::Kind::denied) return hostile(answers[i].problem);
        if (answers[i].kind == RemoteAnswer::Kind::failed) return {Outcome::Kind::no_node, answers[i].problem, {}};
        if (answers[i].bytes.size() != wanted[i].size || sha256(answers[i].bytes) != wanted[i].digest)
            return hostile("its " + path + " has other bytes than it says");
        out.outputs[places[i]] = std::move(answers[i].bytes);
    }
    return {Outcome::Kind::done, {}, {}};
}

}  // namespace

}  // namespace kiln

__attribute__((visibility("default"))) kiln::OpenReapiEngine kiln_grpc_open_engine_1 __asm__("kiln_grpc_open_engine_1");

kiln::Result<std::unique_ptr<kiln::Engine>> kiln_grpc_open_engine_1(std::span<const kiln::RemoteUrl> nodes,
                                                                    const kiln::ReapiOptions& options) {
    auto engine = std::make_unique<kiln::ReapiEngine>(options);
    for (const kiln::RemoteUrl& url : nodes) KILN_TRY(engine->add(url));
    return std::unique_ptr<kiln::Engine>(std::move(engine));
}
