// Starts and ends the front.

#include "cache/server/grpc_server.h"

#include <grpcpp/resource_quota.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include <algorithm>
#include <thread>

#include "cache/server/grpc_call.h"
#include "compiler/base/files.h"

namespace kiln {

struct GrpcCalls {
    std::unique_ptr<CallContext> context;
    std::vector<std::unique_ptr<CallService>> services;
    std::vector<std::unique_ptr<grpc::ServerCompletionQueue>> queues;
    std::unique_ptr<grpc::Server> server;
    std::vector<std::thread> threads;
    int port = 0;
};

GrpcServer::GrpcServer(std::unique_ptr<GrpcCalls> calls) : calls_(std::move(calls)) {}

GrpcServer::~GrpcServer() { drain(std::chrono::seconds(0)); }

uint16_t GrpcServer::port() const { return static_cast<uint16_t>(calls_->port); }

// gRPC wants a queue to be shut down when nothing can be asked of it any more, so the server goes first. A call that was cut is
// over for gRPC then and has yet to hear of it, and its answer needs the queue; those that waited for a client hear of the end
// as well. The pool has no step of any of them after that.
void GrpcServer::drain(std::chrono::seconds patience) {
    if (calls_->server) {
        calls_->server->Shutdown(std::chrono::system_clock::now() + patience);
        calls_->context->ending = true;
        calls_->server->Wait();
    }
    while (calls_->context->calls != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (const auto& queue : calls_->queues) queue->Shutdown();
    for (std::thread& thread : calls_->threads) thread.join();
    calls_->threads.clear();
    calls_->queues.clear();
    calls_->server.reset();
}

Result<std::unique_ptr<GrpcServer>> GrpcServer::start(Service& service, Log& log,
                                                      std::function<std::shared_ptr<const Access>()> access,
                                                      const GrpcOptions& options) {
    auto calls = std::make_unique<GrpcCalls>();
    calls->context.reset(new CallContext{service, log, std::move(access), options, {}, WorkPool(options.work_threads)});
    for (const auto make : {make_capabilities, make_action_cache, make_blobs, make_byte_stream, make_health})
        calls->services.push_back(make(*calls->context));

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

    grpc::ServerBuilder builder;
    builder.AddListeningPort(options.address + ":" + std::to_string(options.port), credentials, &calls->port);
    for (const auto& one : calls->services) builder.RegisterService(&one->service());
    const unsigned queues =
        options.io_threads != 0 ? options.io_threads : std::clamp(std::thread::hardware_concurrency() / 2, 1u, 8u);
    for (unsigned i = 0; i < queues; ++i) calls->queues.push_back(builder.AddCompletionQueue());
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
    for (const auto& queue : calls->queues) {
        if (calls->server && calls->port != 0)
            for (const auto& one : calls->services) one->serve(*queue);
        calls->threads.emplace_back([events = queue.get()] {
            void* call = nullptr;
            bool ok = false;
            while (events->Next(&call, &ok)) static_cast<Call*>(call)->on_event(ok);
        });
    }
    auto front = std::unique_ptr<GrpcServer>(new GrpcServer(std::move(calls)));
    if (!front->calls_->server || front->calls_->port == 0)
        return environment_error("gRPC cannot listen on " + options.address + ":" + std::to_string(options.port));
    return front;
}

}  // namespace kiln
