#pragma once
// What the calls of the gRPC front share. One of the files that include gRPC: its services are generated classes, which the
// sources of the front use.
//
// gRPC's events come to few threads, one on a small machine, since threads that wait for them in turn cost every event a change
// of thread. What may wait for the disk therefore runs in a pool.

#include <grpcpp/grpcpp.h>
#include <remote_execution.grpc.pb.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <type_traits>

#include "cache/protocol/resource_name.h"
#include "cache/server/grpc_deadlines.h"
#include "cache/server/grpc_server.h"
#include "cache/server/patience.h"
#include "cache/server/work_pool.h"

namespace kiln {

namespace reapi = build::bazel::remote::execution::v2;

// Of one message that names many. What is named takes more memory here than on the wire.
constexpr int grpc_most_entries = 32'768;

grpc::Status status_of(const Refused& refused);

struct CallContext {
    Service& service;
    Log& log;
    const std::function<std::shared_ptr<const Access>()> access;
    const GrpcOptions options;
    CallDeadlines deadlines;
    WorkPool work;
    std::atomic<size_t> calls{0};  // that are there, the waiting among them: each needs its queue until its last event
    // Patience with what is under way is over: a call ends at its next step, in loops over many blobs at the next one.
    std::atomic<bool> ending{false};

    // By the metadata "authorization: Bearer T" (or Basic); a field that is neither is no token, and nor are two.
    std::shared_ptr<const Caller> caller(const grpc::ServerContext& context) const;
    // Whether the caller may do that there.
    grpc::Status enter(const Caller& caller, const std::string& instance, Role role) const;
    // What sending or receiving so many bytes may take.
    std::chrono::milliseconds time_for(uint64_t bytes) const { return whole_time(options.patience, bytes, options.slowest); }
};

// One call, from the wait for it to its end, when it deletes itself. Its events come one at a time: begin() and go_on() end with
// the one operation that brings the next event, and may be on another thread already, or over, when that returns.
class Call {
public:
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    void on_event(bool ok);

protected:
    // `method` outlives the call.
    Call(CallContext& shared, grpc::ServerCompletionQueue& queue, const char* method)
        : shared_(shared), queue_(queue), method_(method) {
        ++shared_.calls;
    }
    virtual ~Call() { --shared_.calls; }
    virtual void wait_for_next() = 0;  // makes the object that waits for the next call of this method
    // Of each step, what waits for nothing: who may not call is told so, and memory for what came is taken, before the step
    // stands in line. False: the rest is for begin() or go_on().
    virtual bool begin_at_once() { return false; }
    virtual bool go_on_at_once(bool) { return false; }
    virtual void begin() {}
    virtual void go_on(bool) {}                        // the operation before is done; false: the client is gone
    virtual void end(const grpc::Status& status) = 0;  // by an operation; with ended()
    virtual std::string subject() const = 0;           // for the log: an instance or a resource name
    // Before the operation that sends so many bytes, whose reader may be slow: takes a share of the memory for answers until the
    // next one, and the time that it may take, or that `timed` bytes may. Not ok: `busy`, and the call is to be ended with that.
    grpc::Status hold_answer(uint64_t bytes) { return hold_answer(bytes, bytes); }
    grpc::Status hold_answer(uint64_t bytes, uint64_t timed);
    // Marks the next event as the last, gives it time, and writes the log.
    const grpc::Status& ended(const grpc::Status& status);
    void* tag() { return this; }

    CallContext& shared_;
    grpc::ServerCompletionQueue& queue_;
    grpc::ServerContext context_;
    std::shared_ptr<const Caller> caller_;
    uint64_t in_ = 0, out_ = 0;  // bytes of messages, for the log
    CallDeadlines::Deadline deadline_{shared_.deadlines, context_};

private:
    enum class State { waits, runs, ends };
    template <class Step>
    void guarded(Step step);
    template <class Step>
    void post(Step step);
    const char* const method_;
    State state_ = State::waits;
    Service::Lease answer_;
    std::chrono::steady_clock::time_point began_{};
};

// A call that answers one message by one. Who may not ask is told so at once; what the message takes here is held as a body
// until it is answered, since the disk's line may be long.
template <class Calls, class Request, class Response>
class UnaryCall final : public Call {
public:
    using Writer = grpc::ServerAsyncResponseWriter<Response>;
    struct Method {
        const char* name;
        Calls& service;
        void (Calls::*ask)(grpc::ServerContext*, Request*, Writer*, grpc::CompletionQueue*, grpc::ServerCompletionQueue*, void*);
        std::function<grpc::Status(const Caller&, const Request&)> admit;  // waits for nothing
        std::function<grpc::Status(const Caller&, const Request&, Response&)> answer;
    };
    UnaryCall(CallContext& shared, grpc::ServerCompletionQueue& queue, std::shared_ptr<const Method> method)
        : Call(shared, queue, method->name), what_(std::move(method)) {
        (what_->service.*what_->ask)(&context_, &request_, &writer_, &queue, &queue, tag());
    }

private:
    void wait_for_next() override { new UnaryCall(shared_, queue_, what_); }
    bool begin_at_once() override {
        if (shared_.log.wants_requests()) in_ = request_.ByteSizeLong();
        if (const grpc::Status s = what_->admit(*caller_, request_); !s.ok()) return end(s), true;
        auto lease = shared_.service.lease(request_.SpaceUsedLong());
        if (!lease.ok()) return end(status_of(lease.refused())), true;
        lease_ = std::move(*lease);
        return false;
    }
    void begin() override {
        const grpc::Status status = what_->answer(*caller_, request_, response_);
        if (!status.ok()) return end(status);
        out_ = response_.ByteSizeLong();
        if (const grpc::Status held = hold_answer(out_); !held.ok()) return end(held);
        ended(status);
        forget();
        writer_.Finish(response_, status, tag());
    }
    void end(const grpc::Status& status) override {
        ended(status);
        forget();
        writer_.FinishWithError(status, tag());
    }
    // Who reads the answer slowly does not keep the question here.
    void forget() {
        Request().Swap(&request_);
        lease_ = Service::Lease();
    }
    std::string subject() const override {
        if constexpr (requires { request_.instance_name(); })
            return request_.instance_name();
        else if constexpr (requires { request_.resource_name(); })
            return request_.resource_name();
        else
            return request_.service();
    }

    const std::shared_ptr<const Method> what_;
    Service::Lease lease_;
    Request request_;
    Response response_;
    Writer writer_{&context_};
};

template <class Calls, class Request, class Response, class Admit, class Answer>
void serve_unary(CallContext& shared, grpc::ServerCompletionQueue& queue, const char* name, std::type_identity_t<Calls>& service,
                 void (Calls::*ask)(grpc::ServerContext*, Request*, grpc::ServerAsyncResponseWriter<Response>*,
                                    grpc::CompletionQueue*, grpc::ServerCompletionQueue*, void*),
                 Admit admit, Answer answer) {
    using Method = typename UnaryCall<Calls, Request, Response>::Method;
    new UnaryCall<Calls, Request, Response>(
        shared, queue, std::make_shared<const Method>(Method{name, service, ask, std::move(admit), std::move(answer)}));
}

// A service and the calls that wait on a queue for its methods.
class CallService {
public:
    virtual ~CallService() = default;
    virtual grpc::Service& service() = 0;
    virtual void serve(grpc::ServerCompletionQueue& queue) = 0;
};

std::unique_ptr<CallService> make_capabilities(CallContext& context);
std::unique_ptr<CallService> make_action_cache(CallContext& context);
std::unique_ptr<CallService> make_blobs(CallContext& context);
std::unique_ptr<CallService> make_byte_stream(CallContext& context);
std::unique_ptr<CallService> make_health(CallContext& context);

grpc::Status invalid(const std::string& what);
grpc::Status stopping();
// Only SHA-256 is spoken; 0 is a client that says nothing.
grpc::Status check_function(int digest_function);
std::optional<BlobName> name_of(const reapi::Digest& digest);

}  // namespace kiln
