// gRPC's own health service would bring gRPC's callback threads, which wait for events beside ours and double what a small call
// costs. Of its two methods, Watch is UNIMPLEMENTED, which clients take for a server that is well.

#include <health.grpc.pb.h>

#include "cache/server/grpc_call.h"

namespace kiln {
namespace {

namespace health = grpc::health::v1;

class HealthCalls final : public CallService {
public:
    explicit HealthCalls(CallContext& context) : shared_(context) {}
    grpc::Service& service() override { return service_; }
    void serve(grpc::ServerCompletionQueue& queue) override {
        serve_unary(
            shared_, queue, "Check", service_, &health::Health::AsyncService::RequestCheck,
            [](const Caller&, const health::HealthCheckRequest& request) {
                if (request.service().empty()) return grpc::Status::OK;
                return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such service");
            },
            [](const Caller&, const health::HealthCheckRequest&, health::HealthCheckResponse& out) {
                out.set_status(health::HealthCheckResponse::SERVING);
                return grpc::Status::OK;
            });
    }

private:
    CallContext& shared_;
    health::Health::AsyncService service_;
};

}  // namespace

std::unique_ptr<CallService> make_health(CallContext& context) { return std::make_unique<HealthCalls>(context); }

}  // namespace kiln
