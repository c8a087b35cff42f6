#include "cache/execute/reapi_node.h"

#include <algorithm>

#include "cache/client/grpc_calls.h"

kiln::OpenGrpcRemote kiln_grpc_open_2 __asm__("kiln_grpc_open_2");

namespace kiln {

namespace {

using google::longrunning::Operation;
using Clock = ReapiNode::Clock;

constexpr int most_tries = 5;  // streams opened for one action
constexpr std::chrono::seconds cancel_within{2};
constexpr std::chrono::seconds slow_failure{1};

Outcome outcome_of(int code, const std::string& message) {
    switch (static_cast<grpc::StatusCode>(code)) {
        case grpc::StatusCode::OK:
            return {Outcome::Kind::done, {}, {}};
        case grpc::StatusCode::FAILED_PRECONDITION:
            return {Outcome::Kind::missing, "it misses what it was sent", {}};
        case grpc::StatusCode::UNAVAILABLE:
            return {Outcome::Kind::no_node, "it cannot be reached or went away (" + one_line(message) + ")", {}};
        case grpc::StatusCode::DEADLINE_EXCEEDED:
            return {Outcome::Kind::failed, "it did not end in time", {}};
        case grpc::StatusCode::CANCELLED:
            return {Outcome::Kind::failed, "somebody cancelled it", {}};
        case grpc::StatusCode::UNIMPLEMENTED:
            return {Outcome::Kind::failed, "it does not execute; is it a cache server? That is --cache's", {}};
        case grpc::StatusCode::UNAUTHENTICATED:
        case grpc::StatusCode::PERMISSION_DENIED:
            return {Outcome::Kind::failed, "this token may not execute (KILN_EXECUTE_TOKEN_FILE)", {}};
        // The node's own trouble, a full queue or a store behind it that is away: another node may be better off.
        case grpc::StatusCode::INTERNAL:
        case grpc::StatusCode::UNKNOWN:
        case grpc::StatusCode::ABORTED:
        case grpc::StatusCode::RESOURCE_EXHAUSTED:
            return {Outcome::Kind::no_node, "it answered gRPC status " + std::to_string(code) + ": " + one_line(message), {}};
        default:
            return {Outcome::Kind::failed, "it answered gRPC status " + std::to_string(code) + ": " + one_line(message), {}};
    }
}

// A question that whoever is there answers, in one way or another.
struct Probe {
    grpc::ClientContext context;
    reapi::GetCapabilitiesRequest request;
    reapi::ServerCapabilities response;
    std::atomic<bool> over{false}, answered{false};
};

void set_up(grpc::ClientContext& context, const std::string& token, std::chrono::milliseconds timeout) {
    context.set_deadline(std::chrono::system_clock::now() + timeout);
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
}

}  // namespace

// Follows the stream of one Execute or WaitExecution.
class ReapiNode::Watch final : public grpc::ClientReadReactor<Operation> {
public:
    template <class Open>
    Watch(ReapiNode& node, Clock::time_point end, const Open& open) : node_(node) {
        set_up(context_, node.options_.remote.token, std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()));
        open(&context_, this);
        StartRead(&next_);
        StartCall();
    }
    void OnReadDone(bool ok) override {
        if (!ok) return;
        heard();
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
    // A machine that lost its power says nothing, and neither does one whose worker works: the silent are asked whether they are
    // there.
    void wait() {
        std::shared_ptr<Probe> probe;
        std::unique_lock lock(mutex_);
        while (!over_) {
            if (node_.interrupted() || gone) context_.TryCancel();
            if (probe && probe->over) {
                if (probe->answered)
                    heard();
                else
                    gone = true;
                probe.reset();
            }
            if (!probe && !gone && Clock::now() - Clock::time_point(Clock::duration(heard_)) > node_.options_.silence)
                probe = ask();
            wake_.wait_for(lock, std::chrono::milliseconds(50));
        }
        if (probe) probe->context.TryCancel();
    }

    Operation last;  // the newest that came
    grpc::Status status;
    bool gone = false;  // it did not answer

private:
    void heard() { heard_ = Clock::now().time_since_epoch().count(); }
    std::shared_ptr<Probe> ask() {
        auto probe = std::make_shared<Probe>();
        set_up(probe->context, node_.options_.remote.token, node_.options_.remote.timeout);
        probe->request.set_instance_name(node_.instance_);
        node_.capabilities_->async()->GetCapabilities(
            &probe->context, &probe->request, &probe->response, [probe](const grpc::Status& how) {
                const auto code = how.error_code();
                probe->answered = code != grpc::StatusCode::UNAVAILABLE && code != grpc::StatusCode::DEADLINE_EXCEEDED;
                probe->over = true;
            });
        return probe;
    }

    ReapiNode& node_;
    grpc::ClientContext context_;
    Operation next_;
    std::atomic<Clock::rep> heard_{Clock::now().time_since_epoch().count()};
    std::mutex mutex_;
    std::condition_variable wake_;
    bool over_ = false;
};

ReapiNode::ReapiNode(const RemoteUrl& address, const ReapiOptions& options)
    : url(address), options_(options), instance_(address.path.empty() ? "" : address.path.substr(1)) {
    const auto channel = open_grpc_channel(address, options.remote);
    capabilities_ = reapi::Capabilities::NewStub(channel);
    execution_ = reapi::Execution::NewStub(channel);
    operations_ = google::longrunning::Operations::NewStub(channel);
}

Result<std::unique_ptr<ReapiNode>> ReapiNode::open(const RemoteUrl& url, const ReapiOptions& options) {
    auto node = std::unique_ptr<ReapiNode>(new ReapiNode(url, options));
    GrpcRemoteOptions remote = options.remote;
    remote.inputs = true;
    RemoteLimits limits;
    limits.blob = largest_output;
    auto blobs = kiln_grpc_open_2(url, remote, limits);
    KILN_TRY(blobs);
    node->blobs_ = std::move(*blobs);
    return node;
}

// Before megabytes are sent to a server that can do nothing with them.
std::optional<Outcome> ReapiNode::refusal() {
    if (executes_) return std::nullopt;
    reapi::GetCapabilitiesRequest request;
    request.set_instance_name(instance_);
    reapi::ServerCapabilities can;
    OneCall call;
    call.context = std::make_unique<grpc::ClientContext>();
    set_up(*call.context, options_.remote.token, options_.remote.timeout);
    run_calls({&call}, 1, 1, CallEnd(options_.remote.interrupted), [&](size_t, CallDone done) {
        capabilities_->async()->GetCapabilities(call.context.get(), &request, &can, std::move(done));
    });
    const auto code = call.status.error_code();
    if (code == grpc::StatusCode::DEADLINE_EXCEEDED) return Outcome{Outcome::Kind::no_node, "it did not answer in time", {}};
    if (code != grpc::StatusCode::OK && code != grpc::StatusCode::UNIMPLEMENTED)
        return outcome_of(code, call.status.error_message());
    if (can.has_execution_capabilities() && !can.execution_capabilities().exec_enabled())
        return outcome_of(grpc::StatusCode::UNIMPLEMENTED, {});
    executes_ = true;
    return std::nullopt;
}

Outcome ReapiNode::send(const ReapiAction& action, bool whatever_it_says) {
    const std::lock_guard lock(sending_);
    const auto began = Clock::now();
    // Jobs that stand in line here would otherwise spend, one after the other, the time that the first of them spent.
    if (began.time_since_epoch().count() < silent_until_) return {Outcome::Kind::no_node, "it did not answer a moment ago", {}};
    auto outcome = refusal();
    if (!outcome) outcome = deliver(action, whatever_it_says);
    if (interrupted()) return {Outcome::Kind::failed, "interrupted", {}};
    if (outcome->kind == Outcome::Kind::no_node && Clock::now() - began > slow_failure) silent();
    return *outcome;
}

Outcome ReapiNode::deliver(const ReapiAction& action, bool whatever_it_says) {
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
        const auto found = blobs_->find_blobs(all);
        for (size_t i = 0; i < all.size(); ++i) {
            if (found[i].kind == RemoteAnswer::Kind::found) continue;
            if (found[i].kind != RemoteAnswer::Kind::absent) return trouble(found[i]);
            lacking.push_back({all[i].digest, action.blobs.at(all[i].digest)});
        }
    }
    if (!lacking.empty())
        for (const RemoteAnswer& answer : blobs_->put_blobs(lacking))
            if (answer.kind != RemoteAnswer::Kind::found) return trouble(answer);
    return {Outcome::Kind::done, {}, {}};
}

Outcome ReapiNode::execute(const BlobName& action, bool anew, Clock::time_point end) {
    reapi::ExecuteRequest request;
    request.set_instance_name(instance_);
    request.set_skip_cache_lookup(anew);
    set_digest(request.mutable_action_digest(), action);
    std::string operation;
    Outcome outcome;
    for (int tries = 0; tries < most_tries; ++tries) {
        if (Clock::now() >= end) return {Outcome::Kind::failed, "it did not end in time", {}};
        reapi::WaitExecutionRequest waiting;
        waiting.set_name(operation);
        Watch watch(*this, end, [&](grpc::ClientContext* context, grpc::ClientReadReactor<Operation>* reactor) {
            if (operation.empty())
                execution_->async()->Execute(context, &request, reactor);
            else
                execution_->async()->WaitExecution(context, &waiting, reactor);
        });
        watch.wait();
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
        if (!said.name().empty()) operation = said.name();
        if (watch.gone) {
            silent();
            return {Outcome::Kind::no_node, "it does not answer any more", {}};
        }
        const auto code = watch.status.error_code();
        if (interrupted() || code == grpc::StatusCode::DEADLINE_EXCEEDED) cancel(operation);
        if (interrupted()) return {Outcome::Kind::failed, "interrupted", {}};
        outcome = outcome_of(code, watch.status.error_message());
        if (outcome.kind == Outcome::Kind::done) outcome = {Outcome::Kind::no_node, "it ended without an answer", {}};
        if (!operation.empty() && code == grpc::StatusCode::NOT_FOUND) {
            operation.clear();  // the node was started again
        } else {
            if (outcome.kind != Outcome::Kind::no_node) return outcome;
            if (operation.empty()) return outcome;  // it was never taken: another node may
        }
    }
    return outcome;
}

// As well as can be done within moments; an engine need not offer it.
void ReapiNode::cancel(const std::string& operation) {
    if (operation.empty()) return;
    grpc::ClientContext context;
    set_up(context, options_.remote.token, cancel_within);
    google::longrunning::CancelOperationRequest request;
    request.set_name(operation);
    google::protobuf::Empty nothing;
    static_cast<void>(operations_->CancelOperation(&context, request, &nothing));
}

}  // namespace kiln
