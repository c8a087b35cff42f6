#pragma once
// The gRPC front of kiln-cached over a store of its own, and a client of it.

#include <bytestream.grpc.pb.h>
#include <fcntl.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <health.grpc.pb.h>
#include <remote_execution.grpc.pb.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "cache/protocol/resource_name.h"
#include "cache/server/action_reader.h"
#include "cache/server/grpc_server.h"
#include "cache/zstd.h"
#include "tests/unit/cache/folder.h"

namespace kiln {

namespace re = build::bazel::remote::execution::v2;
namespace bs = google::bytestream;
using grpc::StatusCode;

inline BlobName named(std::string_view bytes) { return {sha256(as_bytes(bytes)), bytes.size()}; }

inline re::Digest digest(const BlobName& name) {
    re::Digest out;
    out.set_hash(name.digest.hex());
    out.set_size_bytes(static_cast<int64_t>(name.size));
    return out;
}

class Grpc : public ::testing::Test {
protected:
    static constexpr const char* tokens =
        "reader rrrrrrrrrrrrrrrrrrrr main:read\n"
        "builder bbbbbbbbbbbbbbbbbbbb main:read,cas-write\n"
        "ci cccccccccccccccccccc main:read,cas-write,ac-write\n"
        "late llllllllllllllllllll main:read,cas-write,ac-write until=2020-01-01\n"
        "pull pppppppppppppppppppp pr/*:read,cas-write,ac-write\n";

    void start(const GrpcOptions& options = {}, const char* access = nullptr, ServiceLimits limits = {}) {
        server_.reset();  // each before what it uses
        service_.reset();
        DiskOptions disk;
        disk.sync = Sync::none;
        auto opened = DiskStore::open(folder_.path(), disk);
        ASSERT_TRUE(opened.ok());
        store_ = std::move(*opened);
        auto instances = Instances::make({{"main", false, false, {}}, {"pr/*", false, false, "main"}, {"raw", true, false, {}}});
        ASSERT_TRUE(instances.ok());
        service_ = std::make_unique<Service>(*store_, std::move(*instances), limits, reapi_reader());
        auto parsed = access ? Access::parse(access, {}) : Result<Access>(Access::open());
        ASSERT_TRUE(parsed.ok());
        access_ = std::make_shared<const Access>(std::move(*parsed));
        auto server = GrpcServer::start(
            *service_, log_, [this] { return access_; }, options);
        ASSERT_TRUE(server.ok()) << server.error().message;
        server_ = std::move(*server);
        grpc::ChannelArguments arguments;
        arguments.SetMaxReceiveMessageSize(-1);
        arguments.SetMaxSendMessageSize(-1);
        channel_ = grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(server_->port()), grpc::InsecureChannelCredentials(),
                                             arguments);
        blobs_ = re::ContentAddressableStorage::NewStub(channel_);
        actions_ = re::ActionCache::NewStub(channel_);
        capabilities_ = re::Capabilities::NewStub(channel_);
        streams_ = bs::ByteStream::NewStub(channel_);
    }

    std::unique_ptr<grpc::ClientContext> context() const {
        auto out = std::make_unique<grpc::ClientContext>();
        out->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
        if (!token_.empty()) out->AddMetadata("authorization", token_);
        return out;
    }
    void as(const std::string& token) { token_ = token.empty() ? "" : "Bearer " + token; }

    StatusCode put(const re::Digest& name, const std::string& bytes, re::Compressor::Value how = re::Compressor::IDENTITY) {
        re::BatchUpdateBlobsRequest request;
        request.set_instance_name(instance_);
        auto& one = *request.add_requests();
        *one.mutable_digest() = name;
        one.set_data(bytes);
        one.set_compressor(how);
        re::BatchUpdateBlobsResponse response;
        const grpc::Status status = blobs_->BatchUpdateBlobs(context().get(), request, &response);
        return status.ok() ? static_cast<StatusCode>(response.responses(0).status().code()) : status.error_code();
    }
    bool missing(const BlobName& name) {
        re::FindMissingBlobsRequest request;
        request.set_instance_name(instance_);
        *request.add_blob_digests() = digest(name);
        re::FindMissingBlobsResponse response;
        EXPECT_TRUE(blobs_->FindMissingBlobs(context().get(), request, &response).ok());
        return response.missing_blob_digests_size() == 1;
    }

    struct Upload {
        Upload(std::string n, std::string b, size_t p = 100'000, bool f = true, int64_t s = 0, std::string l = {})
            : name(std::move(n)), bytes(std::move(b)), piece(p), finish(f), shift(s), later(std::move(l)) {}
        std::string name, bytes;
        size_t piece;
        bool finish;
        int64_t shift;      // of every offset
        std::string later;  // another name from the second message on
    };
    grpc::Status upload(const Upload& u, int64_t* committed = nullptr) {
        bs::WriteResponse response;
        const auto held = context();
        auto writer = streams_->Write(held.get(), &response);
        for (size_t at = 0; at == 0 || at < u.bytes.size(); at += u.piece) {
            bs::WriteRequest request;
            request.set_resource_name(at == 0 || u.later.empty() ? u.name : u.later);
            request.set_write_offset(static_cast<int64_t>(at) + u.shift);
            request.set_data(u.bytes.substr(at, u.piece));
            request.set_finish_write(u.finish && at + u.piece >= u.bytes.size());
            if (!writer->Write(request)) break;
        }
        writer->WritesDone();
        const grpc::Status status = writer->Finish();
        if (committed) *committed = response.committed_size();
        return status;
    }
    grpc::Status download(const std::string& name, std::string& out, int64_t offset = 0, int64_t limit = 0) {
        bs::ReadRequest request;
        request.set_resource_name(name);
        request.set_read_offset(offset);
        request.set_read_limit(limit);
        const auto held = context();
        auto reader = streams_->Read(held.get(), request);
        bs::ReadResponse response;
        out.clear();
        while (reader->Read(&response)) out += response.data();
        return reader->Finish();
    }
    StatusCode put_action(const BlobName& key, const re::ActionResult& value, re::ActionResult* held = nullptr) {
        re::UpdateActionResultRequest request;
        request.set_instance_name(instance_);
        *request.mutable_action_digest() = digest(key);
        *request.mutable_action_result() = value;
        re::ActionResult response;
        const StatusCode code = actions_->UpdateActionResult(context().get(), request, &response).error_code();
        if (held) *held = response;
        return code;
    }
    StatusCode get_action(const BlobName& key, re::ActionResult* out = nullptr) {
        re::GetActionResultRequest request;
        request.set_instance_name(instance_);
        *request.mutable_action_digest() = digest(key);
        re::ActionResult response;
        const StatusCode code = actions_->GetActionResult(context().get(), request, &response).error_code();
        if (out) *out = response;
        return code;
    }
    static re::ActionResult result(const BlobName& output, const std::string& path = "out.bin") {
        re::ActionResult out;
        auto& file = *out.add_output_files();
        file.set_path(path);
        *file.mutable_digest() = digest(output);
        out.set_exit_code(3);
        return out;
    }

    TestFolder folder_;
    std::unique_ptr<DiskStore> store_;
    std::unique_ptr<Service> service_;
    std::shared_ptr<const Access> access_;
    const std::string log_file_ = folder_.path() + "-log";
    Descriptor log_to_{::open(log_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)};
    Log log_{log_to_.get(), LogLevel::requests};
    std::unique_ptr<GrpcServer> server_;
    std::shared_ptr<grpc::Channel> channel_;
    std::unique_ptr<re::ContentAddressableStorage::Stub> blobs_;
    std::unique_ptr<re::ActionCache::Stub> actions_;
    std::unique_ptr<re::Capabilities::Stub> capabilities_;
    std::unique_ptr<bs::ByteStream::Stub> streams_;
    std::string instance_ = "main", token_;
};

}  // namespace kiln
