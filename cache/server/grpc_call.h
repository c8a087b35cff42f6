#pragma once
// What the calls of the gRPC front share. One of the files that include gRPC: its services are generated classes, which the
// three sources of the front derive from.

#include <grpcpp/alarm.h>
#include <grpcpp/grpcpp.h>
#include <remote_execution.grpc.pb.h>

#include "cache/protocol/resource_name.h"
#include "cache/server/grpc_server.h"

namespace kiln {

namespace reapi = build::bazel::remote::execution::v2;

struct CallContext {
    Service& service;
    const std::function<std::shared_ptr<const Access>()> access;
    const GrpcOptions options;

    // By the metadata "authorization: Bearer T" (or Basic); a field that is neither is no token.
    Caller caller(const grpc::CallbackServerContext& context) const;
};

grpc::Status status_of(const Refused& refused);
grpc::Status invalid(const std::string& what);
// Only SHA-256 is spoken; 0 is a client that says nothing.
grpc::Status check_function(int digest_function);
std::optional<BlobName> name_of(const reapi::Digest& digest);
void set_digest(reapi::Digest* out, const BlobName& name);

std::unique_ptr<grpc::Service> make_capabilities(CallContext& context);
std::unique_ptr<grpc::Service> make_action_cache(CallContext& context);
std::unique_ptr<grpc::Service> make_blobs(CallContext& context);
std::unique_ptr<grpc::Service> make_byte_stream(CallContext& context);

// Ends a call that takes too long. The call and its context may be gone when the time comes.
class CallTimer {
public:
    CallTimer(grpc::CallbackServerContext* context, std::chrono::seconds after);
    ~CallTimer();

private:
    struct Shared {
        std::mutex mutex;
        grpc::CallbackServerContext* context;
    };
    std::shared_ptr<Shared> shared_;
    grpc::Alarm alarm_;
};

}  // namespace kiln
