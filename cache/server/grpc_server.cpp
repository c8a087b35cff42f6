// Starts and ends the front, and what its calls share.

#include "cache/server/grpc_server.h"

#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include <ctime>

#include "cache/server/grpc_call.h"
#include "cache/server/http_face.h"
#include "compiler/base/files.h"

namespace kiln {

Caller CallContext::caller(const grpc::CallbackServerContext& context) const {
    const std::shared_ptr<const Access> tokens = access();
    const auto field = context.client_metadata().find("authorization");
    if (field == context.client_metadata().end()) return tokens->anonymous();
    const auto token = token_of({field->second.data(), field->second.size()});
    return tokens->caller(token ? *token : " ", std::time(nullptr));  // no token holds a space
}

grpc::Status status_of(const Refused& refused) {
    const auto code = [&] {
        switch (refused.why) {
            case Refusal::bad_request:
            case Refusal::unknown_instance:
                return grpc::StatusCode::INVALID_ARGUMENT;
            case Refusal::unauthenticated:
                return grpc::StatusCode::UNAUTHENTICATED;
            case Refusal::forbidden:
                return grpc::StatusCode::PERMISSION_DENIED;
            case Refusal::busy:
                return grpc::StatusCode::UNAVAILABLE;
            case Refusal::too_large:
            case Refusal::full:
                return grpc::StatusCode::RESOURCE_EXHAUSTED;
            case Refusal::failed:
                break;
        }
        return grpc::StatusCode::INTERNAL;
    };
    return {code(), refused.message};
}

grpc::Status invalid(const std::string& what) { return {grpc::StatusCode::INVALID_ARGUMENT, what}; }

grpc::Status check_function(int digest_function) {
    if (digest_function == reapi::DigestFunction::UNKNOWN || digest_function == reapi::DigestFunction::SHA256)
        return grpc::Status::OK;
    return invalid("this server speaks SHA-256 alone");
}

std::optional<BlobName> name_of(const reapi::Digest& digest) { return blob_name(digest.hash(), digest.size_bytes()); }

void set_digest(reapi::Digest* out, const BlobName& name) {
    out->set_hash(name.digest.hex());
    out->set_size_bytes(static_cast<int64_t>(name.size));
}

CallTimer::CallTimer(grpc::CallbackServerContext* context, std::chrono::seconds after) : shared_(std::make_shared<Shared>()) {
    shared_->context = context;
    // What the alarm calls belongs to gRPC until it has run, which the alarm's end makes happen at once.
    alarm_.Set(std::chrono::system_clock::now() + after, [shared = shared_](bool expired) {
        const std::lock_guard lock(shared->mutex);
        if (expired && shared->context != nullptr) shared->context->TryCancel();
    });
}

CallTimer::~CallTimer() {
    const std::lock_guard lock(shared_->mutex);
    shared_->context = nullptr;
}

struct GrpcCalls {
    CallContext context;
    std::vector<std::unique_ptr<grpc::Service>> services;
    std::unique_ptr<grpc::Server> server;
    int port = 0;
};

GrpcServer::GrpcServer(std::unique_ptr<GrpcCalls> calls) : calls_(std::move(calls)) {}

GrpcServer::~GrpcServer() { drain(std::chrono::seconds(0)); }

uint16_t GrpcServer::port() const { return static_cast<uint16_t>(calls_->port); }

void GrpcServer::drain(std::chrono::seconds patience) {
    calls_->server->Shutdown(std::chrono::system_clock::now() + patience);
    calls_->server->Wait();
}

Result<std::unique_ptr<GrpcServer>> GrpcServer::start(Service& service, std::function<std::shared_ptr<const Access>()> access,
                                                      const GrpcOptions& options) {
    auto calls = std::unique_ptr<GrpcCalls>(new GrpcCalls{{service, std::move(access), options}, {}, nullptr, 0});
    calls->services.push_back(make_capabilities(calls->context));
    calls->services.push_back(make_action_cache(calls->context));
    calls->services.push_back(make_blobs(calls->context));
    calls->services.push_back(make_byte_stream(calls->context));

    std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
    if (!options.certificate.empty()) {
        for (const std::string& file : {options.certificate, options.key}) {
            const auto text = DiskFiles().read(file);
            KILN_TRY(text);
            if (!text->has_value()) return input_error(file + ": no such file");
        }
        namespace tls = grpc::experimental;
        tls::TlsServerCredentialsOptions how(std::make_shared<tls::FileWatcherCertificateProvider>(
            options.key, options.certificate, static_cast<unsigned>(options.look_again.count())));
        how.watch_identity_key_cert_pairs();
        credentials = tls::TlsServerCredentials(how);
    }

    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    builder.AddListeningPort(options.address + ":" + std::to_string(options.port), credentials, &calls->port);
    for (const auto& one : calls->services) builder.RegisterService(one.get());
    builder.SetMaxReceiveMessageSize(grpc_most_message);
    builder.SetMaxSendMessageSize(grpc_most_message);
    builder.SetResourceQuota(grpc::ResourceQuota("kiln-cached").Resize(service.limits().in_flight));
    builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
    builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 * 1024);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, 10 * 60 * 1000);
    // A peer that is gone without a word is noticed; one that pings for nothing is sent away.
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 60 * 1000);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20 * 1000);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10 * 1000);
    calls->server = builder.BuildAndStart();
    if (!calls->server || calls->port == 0)
        return environment_error("gRPC cannot listen on " + options.address + ":" + std::to_string(options.port));
    return std::unique_ptr<GrpcServer>(new GrpcServer(std::move(calls)));
}

}  // namespace kiln
