#pragma once
// A server of the Remote Execution API in this process: honest over a map, until a test replaces one of its answers.

#include <bytestream.grpc.pb.h>
#include <grpcpp/grpcpp.h>
#include <remote_execution.grpc.pb.h>

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "cache/client/grpc_remote.h"
#include "cache/protocol/resource_name.h"
#include "compiler/base/bytes.h"

kiln::OpenGrpcRemote kiln_grpc_open_2 __asm__("kiln_grpc_open_2");

namespace kiln::testing {

namespace reapi = build::bazel::remote::execution::v2;
using grpc::ServerContext;

class Liar final : public reapi::Capabilities::Service,
                   public reapi::ActionCache::Service,
                   public reapi::ContentAddressableStorage::Service,
                   public google::bytestream::ByteStream::Service {
public:
    explicit Liar(const std::vector<grpc::Service*>& more = {}) {
        capabilities.mutable_cache_capabilities()->add_digest_functions(reapi::DigestFunction::SHA256);
        capabilities.mutable_cache_capabilities()->mutable_action_cache_update_capabilities()->set_update_enabled(true);
        versions(2, 0, 2, 11);
        grpc::ServerBuilder builder;
        builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
        builder.SetMaxSendMessageSize(-1);
        builder.RegisterService(static_cast<reapi::Capabilities::Service*>(this));
        builder.RegisterService(static_cast<reapi::ActionCache::Service*>(this));
        builder.RegisterService(static_cast<reapi::ContentAddressableStorage::Service*>(this));
        builder.RegisterService(static_cast<google::bytestream::ByteStream::Service*>(this));
        for (grpc::Service* service : more) builder.RegisterService(service);
        server = builder.BuildAndStart();
    }
    ~Liar() override { stop(); }
    void stop() {
        ending = true;
        if (server) server->Shutdown(std::chrono::system_clock::now());
        server.reset();
    }

    void versions(int low_major, int low, int high_major, int high) {
        capabilities.mutable_low_api_version()->set_major(low_major);
        capabilities.mutable_low_api_version()->set_minor(low);
        capabilities.mutable_high_api_version()->set_major(high_major);
        capabilities.mutable_high_api_version()->set_minor(high);
    }
    // Until the client has gone.
    void hang(ServerContext* context) const {
        while (!context->IsCancelled() && !ending) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::unique_ptr<RemoteStore> client(std::chrono::milliseconds timeout = std::chrono::seconds(20),
                                        const std::string& secret = {}, const std::atomic<bool>* interrupted = nullptr,
                                        RemoteLimits limits = {}) const {
        GrpcRemoteOptions options;
        options.timeout = timeout;
        options.token = secret;
        options.interrupted = interrupted;
        const auto url = RemoteUrl::parse("grpc://127.0.0.1:" + std::to_string(port) + "/team/main");
        return std::move(*kiln_grpc_open_2(*url, options, limits));
    }

    grpc::Status GetCapabilities(ServerContext* context, const reapi::GetCapabilitiesRequest* request,
                                 reapi::ServerCapabilities* out) override {
        ++calls;
        instance = request->instance_name();
        const auto token_sent = context->client_metadata().find("authorization");
        token = token_sent == context->client_metadata().end()
                    ? ""
                    : std::string(token_sent->second.data(), token_sent->second.size());
        if (on_capabilities) return on_capabilities(context, out);
        *out = capabilities;
        return grpc::Status::OK;
    }
    grpc::Status GetActionResult(ServerContext* context, const reapi::GetActionResultRequest* request,
                                 reapi::ActionResult* out) override {
        ++calls;
        if (on_get_action) return on_get_action(context, out);
        const std::lock_guard lock(mutex);
        const auto found = actions.find(request->action_digest().hash());
        if (found == actions.end()) return {grpc::StatusCode::NOT_FOUND, ""};
        *out = found->second;
        return grpc::Status::OK;
    }
    grpc::Status UpdateActionResult(ServerContext*, const reapi::UpdateActionResultRequest* request,
                                    reapi::ActionResult* out) override {
        ++calls;
        const std::lock_guard lock(mutex);
        *out = actions.emplace(request->action_digest().hash(), request->action_result()).first->second;  // the first one stays
        return grpc::Status::OK;
    }
    grpc::Status FindMissingBlobs(ServerContext*, const reapi::FindMissingBlobsRequest* request,
                                  reapi::FindMissingBlobsResponse* out) override {
        ++calls;
        const std::lock_guard lock(mutex);
        for (const auto& digest : request->blob_digests())
            if (blobs.count(digest.hash()) == 0) *out->add_missing_blob_digests() = digest;
        return grpc::Status::OK;
    }
    grpc::Status BatchUpdateBlobs(ServerContext* context, const reapi::BatchUpdateBlobsRequest* request,
                                  reapi::BatchUpdateBlobsResponse* out) override {
        ++calls;
        ++batches;
        if (on_put) return on_put(context, *request, out);
        const std::lock_guard lock(mutex);
        for (const auto& one : request->requests()) {
            blobs[one.digest().hash()] = one.data();
            *out->add_responses()->mutable_digest() = one.digest();
        }
        return grpc::Status::OK;
    }
    grpc::Status BatchReadBlobs(ServerContext* context, const reapi::BatchReadBlobsRequest* request,
                                reapi::BatchReadBlobsResponse* out) override {
        ++calls;
        ++batches;
        asked += static_cast<size_t>(request->digests_size());
        if (on_read) return on_read(context, *request, out);
        const std::lock_guard lock(mutex);
        for (int i = request->digests_size(); i-- > 0;) {  // in another order: the API promises none
            auto& one = *out->add_responses();
            *one.mutable_digest() = request->digests(i);
            const auto found = blobs.find(request->digests(i).hash());
            if (found == blobs.end())
                one.mutable_status()->set_code(5);
            else
                one.set_data(found->second);
        }
        return grpc::Status::OK;
    }
    grpc::Status Read(ServerContext* context, const google::bytestream::ReadRequest* request,
                      grpc::ServerWriter<google::bytestream::ReadResponse>* out) override {
        ++calls;
        ++streams;
        if (on_stream) return on_stream(context, out);
        const auto name = parse_resource_name(request->resource_name());
        if (!name || name->instance != "team/main") return {grpc::StatusCode::INVALID_ARGUMENT, "name"};
        std::string all;
        {
            const std::lock_guard lock(mutex);
            const auto found = blobs.find(name->blob.digest.hex());
            if (found == blobs.end()) return {grpc::StatusCode::NOT_FOUND, ""};
            all = found->second;
        }
        google::bytestream::ReadResponse piece;
        for (size_t at = 0; at < all.size(); at += 700'000) {
            piece.set_data(all.substr(at, 700'000));
            out->Write(piece);
        }
        return grpc::Status::OK;
    }
    grpc::Status Write(ServerContext*, grpc::ServerReader<google::bytestream::WriteRequest>* in,
                       google::bytestream::WriteResponse* out) override {
        ++calls;
        ++streams;
        google::bytestream::WriteRequest piece;
        std::string name, all;
        bool finished = false;
        while (in->Read(&piece)) {
            if (name.empty()) name = piece.resource_name();
            if (piece.write_offset() != static_cast<int64_t>(all.size()) || finished)
                return {grpc::StatusCode::INVALID_ARGUMENT, "offset"};
            const auto parsed = parse_resource_name(name);
            if (!parsed || !parsed->upload) return {grpc::StatusCode::INVALID_ARGUMENT, "name"};
            if (has_already) {
                out->set_committed_size(static_cast<int64_t>(parsed->blob.size));
                return grpc::Status::OK;
            }
            all += piece.data();
            finished = piece.finish_write();
        }
        const auto parsed = parse_resource_name(name);
        if (!finished || !parsed || parsed->blob.size != all.size()) return {grpc::StatusCode::INVALID_ARGUMENT, "unfinished"};
        out->set_committed_size(static_cast<int64_t>(all.size()) - takes_less);
        const std::lock_guard lock(mutex);
        blobs[parsed->blob.digest.hex()] = all;
        return grpc::Status::OK;
    }

    int port = 0;
    reapi::ServerCapabilities capabilities;
    std::atomic<size_t> calls{0}, batches{0}, streams{0}, asked{0};
    std::string instance, token;
    bool has_already = false;
    int64_t takes_less = 0;
    std::function<grpc::Status(ServerContext*, reapi::ServerCapabilities*)> on_capabilities;
    std::function<grpc::Status(ServerContext*, reapi::ActionResult*)> on_get_action;
    std::function<grpc::Status(ServerContext*, const reapi::BatchUpdateBlobsRequest&, reapi::BatchUpdateBlobsResponse*)> on_put;
    std::function<grpc::Status(ServerContext*, const reapi::BatchReadBlobsRequest&, reapi::BatchReadBlobsResponse*)> on_read;
    std::function<grpc::Status(ServerContext*, grpc::ServerWriter<google::bytestream::ReadResponse>*)> on_stream;
    std::mutex mutex;
    std::map<std::string, std::string> blobs;
    std::map<std::string, reapi::ActionResult> actions;
    std::atomic<bool> ending{false};
    std::unique_ptr<grpc::Server> server;
};

}  // namespace kiln::testing
