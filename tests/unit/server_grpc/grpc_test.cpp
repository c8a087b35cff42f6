// kiln-cached's gRPC front as its clients meet it, well-behaved and not. Every refusal stands beside the call that passes.
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
namespace {

namespace re = build::bazel::remote::execution::v2;
namespace bs = google::bytestream;
using grpc::StatusCode;

BlobName named(std::string_view bytes) { return {sha256(as_bytes(bytes)), bytes.size()}; }

re::Digest digest(const BlobName& name) {
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
        "pull pppppppppppppppppppp pr/*:read,cas-write,ac-write\n";

    void start(const GrpcOptions& options = {}, const char* access = nullptr, ServiceLimits limits = {}) {
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

TEST_F(Grpc, SaysWhatItCanDo) {
    start({}, tokens);
    const auto ask = [&](const std::string& token) {
        as(token);
        re::GetCapabilitiesRequest request;
        request.set_instance_name("main");
        re::ServerCapabilities out;
        const grpc::Status status = capabilities_->GetCapabilities(context().get(), request, &out);
        EXPECT_TRUE(status.ok()) << status.error_message();
        return out;
    };
    const re::ServerCapabilities ci = ask("cccccccccccccccccccc");
    EXPECT_EQ(ci.low_api_version().major(), 2);
    EXPECT_EQ(ci.low_api_version().minor(), 0);
    EXPECT_EQ(ci.high_api_version().minor(), 11);
    ASSERT_EQ(ci.cache_capabilities().digest_functions_size(), 1);
    EXPECT_EQ(ci.cache_capabilities().digest_functions(0), re::DigestFunction::SHA256);
    EXPECT_TRUE(ci.cache_capabilities().action_cache_update_capabilities().update_enabled());
    EXPECT_FALSE(ci.has_execution_capabilities());
    EXPECT_FALSE(ask("rrrrrrrrrrrrrrrrrrrr").cache_capabilities().action_cache_update_capabilities().update_enabled());
    EXPECT_FALSE(ask("bbbbbbbbbbbbbbbbbbbb").cache_capabilities().action_cache_update_capabilities().update_enabled());
}

TEST_F(Grpc, StoresABatchOfBlobsThatMatchTheirNamesAndNoOther) {
    start();
    const std::string bytes = "the bytes of a module";
    const BlobName name = named(bytes);
    EXPECT_TRUE(missing(name));
    re::Digest wrong = digest(named("other bytes"));
    wrong.set_size_bytes(static_cast<int64_t>(bytes.size()));
    EXPECT_EQ(put(wrong, bytes), StatusCode::INVALID_ARGUMENT);
    for (const std::string& hash :
         {std::string("../../../../tmp/evil"), name.digest.hex().substr(1), name.digest.hex() + "0", std::string(),
          std::string(64, 'F'), "/" + name.digest.hex().substr(1), std::string(64, '\0')}) {
        re::Digest bad = digest(name);
        bad.set_hash(hash);
        EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT) << hash;
    }
    for (const int64_t size : {int64_t{-1}, int64_t{0}, static_cast<int64_t>(bytes.size()) - 1, INT64_MAX, INT64_MIN}) {
        re::Digest bad = digest(name);
        bad.set_size_bytes(size);
        EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT) << size;
    }
    EXPECT_TRUE(missing(name));
    EXPECT_EQ(put(digest(name), bytes), StatusCode::OK);
    EXPECT_FALSE(missing(name));
    // Another size of a blob that is there is another blob, and a lie.
    re::Digest bad = digest(name);
    bad.set_size_bytes(5);
    EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing({name.digest, 5}));
    EXPECT_EQ(store_->stats()->blob.entries, 1u);
}

TEST_F(Grpc, HasTheEmptyBlobAtAllTimes) {
    start();
    EXPECT_FALSE(missing(named("")));
    std::string out;
    EXPECT_TRUE(download(read_name("main", named("")), out).ok());
    EXPECT_EQ(put(digest(named("")), ""), StatusCode::OK);
}

TEST_F(Grpc, UnpacksCompressedBlobsWithinTheirSize) {
    start();
    const std::string bytes(1'000'000, 'z');
    const Bytes packed = zstd_compress(as_bytes(bytes), 3);
    EXPECT_EQ(put(digest({named(bytes).digest, 1000}), std::string(as_text(packed)), re::Compressor::ZSTD),
              StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(put(digest(named(bytes)), "no zstd", re::Compressor::ZSTD), StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(put(digest(named(bytes)), std::string(as_text(packed)), re::Compressor::BROTLI), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing(named(bytes)));
    EXPECT_EQ(put(digest(named(bytes)), std::string(as_text(packed)), re::Compressor::ZSTD), StatusCode::OK);
    EXPECT_FALSE(missing(named(bytes)));
}

TEST_F(Grpc, ReadsBatchesWithinTheAnnouncedSize) {
    start();
    re::BatchReadBlobsRequest request;
    request.set_instance_name("main");
    std::vector<std::string> all;
    for (int i = 0; i < 40; ++i) {
        all.push_back(std::string(60'000, static_cast<char>('a' + i % 26)) + std::to_string(i));
        ASSERT_EQ(put(digest(named(all.back())), all.back()), StatusCode::OK);
        *request.add_digests() = digest(named(all.back()));
    }
    *request.add_digests() = digest(named("never stored"));
    re::BatchReadBlobsResponse response;
    ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
    ASSERT_EQ(response.responses_size(), 41);
    for (int i = 0; i < 40; ++i) EXPECT_EQ(response.responses(i).data(), all[static_cast<size_t>(i)]);
    EXPECT_EQ(response.responses(40).status().code(), StatusCode::NOT_FOUND);
    // A second time, from memory or a trusted file, and in a batch that is small enough not to leave the thread of the sockets.
    for (const int count : {40, 3}) {
        request.mutable_digests()->DeleteSubrange(count, request.digests_size() - count);
        ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
        ASSERT_EQ(response.responses_size(), count);
        for (int i = 0; i < count; ++i) {
            EXPECT_EQ(response.responses(i).data(), all[static_cast<size_t>(i)]);
            EXPECT_EQ(response.responses(i).digest().SerializeAsString(), request.digests(i).SerializeAsString());
        }
    }
    // Sizes on both sides of what is copied and what is kept in memory, the empty blob, and one of another size than it has.
    request.clear_digests();
    all.clear();
    for (const size_t size : {size_t{0}, size_t{1}, size_t{4095}, size_t{4096}, size_t{32'768}, size_t{32'769}}) {
        all.push_back(std::string(size, 'k'));
        ASSERT_EQ(put(digest(named(all.back())), all.back()), StatusCode::OK);
        *request.add_digests() = digest(named(all.back()));
    }
    request.add_digests()->CopyFrom(digest({named(all[1]).digest, 2}));
    for (int time = 0; time < 3; ++time) {
        ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
        ASSERT_EQ(response.responses_size(), 7);
        for (size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(response.responses(static_cast<int>(i)).data() == all[i]);
        EXPECT_EQ(response.responses(6).status().code(), StatusCode::NOT_FOUND);
        std::this_thread::sleep_for(std::chrono::milliseconds(60));  // a file must be older than a tick to be trusted
    }
    EXPECT_EQ(service_->counters().total().blob_misses, 1u);  // the blob that was never stored
    request.add_digests()->CopyFrom(digest({named("x").digest, grpc_most_batch}));
    EXPECT_EQ(blobs_->BatchReadBlobs(context().get(), request, &response).error_code(), StatusCode::INVALID_ARGUMENT);
}

TEST_F(Grpc, RefusesAMessageThatIsTooLargeBeforeItIsRead) {
    start();
    const std::string bytes(5 * 1024 * 1024, 'b');
    EXPECT_EQ(put(digest(named(bytes)), bytes), StatusCode::RESOURCE_EXHAUSTED);
    const std::string less(grpc_most_batch - 4096, 'b');
    EXPECT_EQ(put(digest(named(less)), less), StatusCode::OK);
}

TEST_F(Grpc, StreamsBlobsBothWays) {
    start();
    std::string bytes;
    for (int64_t i = 0; bytes.size() < 5'000'000; ++i) bytes += std::to_string(i * 7919) + " ";
    const BlobName name = named(bytes);
    int64_t committed = 0;
    ASSERT_TRUE(upload({upload_name("main", "u1", name), bytes}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(bytes.size()));
    std::string out;
    ASSERT_TRUE(download(read_name("main", name), out).ok());
    EXPECT_TRUE(out == bytes);
    ASSERT_TRUE(download(read_name("main", name), out, 1'234'567, 4'321).ok());
    EXPECT_EQ(out, bytes.substr(1'234'567, 4'321));
    ASSERT_TRUE(download(read_name("main", name), out, static_cast<int64_t>(bytes.size())).ok());
    EXPECT_EQ(out, "");
    EXPECT_EQ(download(read_name("main", name), out, static_cast<int64_t>(bytes.size()) + 1).error_code(),
              StatusCode::OUT_OF_RANGE);
    EXPECT_EQ(download(read_name("main", name), out, -1).error_code(), StatusCode::OUT_OF_RANGE);
    EXPECT_EQ(download(read_name("main", name), out, 0, -1).error_code(), StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(download(read_name("main", {name.digest, 7}), out).error_code(), StatusCode::NOT_FOUND);
    const std::string packed_name = "main/compressed-blobs/zstd/" + name.digest.hex() + "/" + std::to_string(name.size);
    ASSERT_TRUE(download(packed_name, out).ok());
    EXPECT_LT(out.size(), bytes.size());
    Bytes plain;
    ASSERT_EQ(zstd_unpack(as_bytes(out), bytes.size(), plain), Unpacked::ok);
    EXPECT_TRUE(as_text(plain) == bytes);
    // What is there already is not sent again.
    ASSERT_TRUE(upload({upload_name("main", "u2", name), bytes}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(bytes.size()));
}

TEST_F(Grpc, TakesACompressedUpload) {
    start();
    const std::string bytes(3'000'000, 'q');
    const BlobName name = named(bytes);
    const std::string packed(as_text(zstd_compress(as_bytes(bytes), 3)));
    const std::string to = "main/uploads/u/compressed-blobs/zstd/" + name.digest.hex() + "/" + std::to_string(name.size);
    EXPECT_EQ(upload({"main/uploads/u/compressed-blobs/zstd/" + name.digest.hex() + "/1000", packed}).error_code(),
              StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(upload({to, packed.substr(0, packed.size() - 3)}).error_code(), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing(name));
    int64_t committed = 0;
    ASSERT_TRUE(upload({to, packed}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(packed.size()));
    EXPECT_FALSE(missing(name));
    ASSERT_TRUE(upload({to, packed}, &committed).ok());
    EXPECT_EQ(committed, -1);
}

TEST_F(Grpc, AnUploadThatIsNotWholeLeavesNothing) {
    start();
    const std::string bytes(300'000, 'w');
    const BlobName name = named(bytes);
    const std::string to = upload_name("main", "u", name);
    const auto refused = [&](const Upload& u) {
        EXPECT_EQ(upload(u).error_code(), StatusCode::INVALID_ARGUMENT) << u.name << " " << u.bytes.size();
    };
    refused({to, bytes, 100'000, false});
    refused({to, bytes.substr(1)});
    refused({to, bytes + "w"});
    refused({to, std::string(300'000, 'v')});
    refused({to, bytes, 100'000, true, 1});
    refused({to, bytes, 100'000, true, 0, upload_name("main", "other", name)});
    refused({read_name("main", name), bytes});
    refused({"", bytes});
    refused({"main/uploads/u/blobs/../../etc/passwd/300000", bytes});
    refused({"main/uploads/u/compressed-blobs/brotli/" + name.digest.hex() + "/300000", bytes});
    EXPECT_TRUE(missing(name));
    EXPECT_EQ(store_->stats()->entries().entries, 0u);
    bs::QueryWriteStatusRequest ask;
    ask.set_resource_name(to);
    bs::QueryWriteStatusResponse state;
    ASSERT_TRUE(streams_->QueryWriteStatus(context().get(), ask, &state).ok());
    EXPECT_FALSE(state.complete());
    EXPECT_EQ(state.committed_size(), 0);
    EXPECT_TRUE(upload({to, bytes}).ok());
    ASSERT_TRUE(streams_->QueryWriteStatus(context().get(), ask, &state).ok());
    EXPECT_TRUE(state.complete());
    server_.reset();  // a client hears of a call's end before the call is taken apart
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, RefusesABlobBeyondTheLimitFromItsNameAlone) {
    ServiceLimits limits;
    limits.blob = 1'000'000;
    start({}, nullptr, limits);
    EXPECT_EQ(upload({upload_name("main", "u", {named("x").digest, 1'000'001}), "x"}).error_code(),
              StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(upload({upload_name("main", "u", {named("x").digest, INT64_MAX}), "x"}).error_code(),
              StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_TRUE(upload({upload_name("main", "u", named("x")), "x"}).ok());
}

TEST_F(Grpc, EndsAnUploadThatTakesTooLong) {
    GrpcOptions options;
    options.patience = std::chrono::seconds(1);
    start(options);
    bs::WriteResponse response;
    const auto held = context();
    auto writer = streams_->Write(held.get(), &response);
    bs::WriteRequest request;
    request.set_resource_name(upload_name("main", "u", named("abc")));
    request.set_data("a");
    ASSERT_TRUE(writer->Write(request));
    EXPECT_EQ(writer->Finish().error_code(), StatusCode::CANCELLED);  // by the server: our own deadline is a minute away
    EXPECT_TRUE(upload({upload_name("main", "u", named("abc")), "abc"}).ok());
}

TEST_F(Grpc, AnActionIsAHitOnlyWithItsBlobs) {
    start();
    const BlobName key = named("an action"), output = named("its output");
    EXPECT_EQ(get_action(key), StatusCode::NOT_FOUND);
    ASSERT_EQ(put_action(key, result(output)), StatusCode::OK);
    EXPECT_EQ(get_action(key), StatusCode::NOT_FOUND);
    ASSERT_EQ(put(digest(output), "its output"), StatusCode::OK);
    re::ActionResult got;
    ASSERT_EQ(get_action(key, &got), StatusCode::OK);
    EXPECT_EQ(got.SerializeAsString(), result(output).SerializeAsString());
}

TEST_F(Grpc, TheFirstValueOfAnActionStays) {
    start();
    const BlobName key = named("an action"), output = named("one"), other = named("two");
    for (const std::string& bytes : {std::string("one"), std::string("two")})
        ASSERT_EQ(put(digest(named(bytes)), bytes), StatusCode::OK);
    ASSERT_EQ(put_action(key, result(output)), StatusCode::OK);
    re::ActionResult held;
    EXPECT_EQ(put_action(key, result(other), &held), StatusCode::OK);
    EXPECT_EQ(held.output_files(0).digest().hash(), output.digest.hex());
    re::ActionResult got;
    ASSERT_EQ(get_action(key, &got), StatusCode::OK);
    EXPECT_EQ(got.output_files(0).digest().hash(), output.digest.hex());
    EXPECT_EQ(service_->counters().total().conflicts, 1u);
}

TEST_F(Grpc, RefusesActionsThatAreNone) {
    start();
    re::ActionResult bad = result(named("x"));
    bad.mutable_output_files(0)->mutable_digest()->set_hash("../../etc/passwd");
    EXPECT_EQ(put_action(named("a"), bad), StatusCode::INVALID_ARGUMENT);
    bad = result(named("x"));
    bad.mutable_output_files(0)->clear_digest();
    EXPECT_EQ(put_action(named("a"), bad), StatusCode::INVALID_ARGUMENT);
    re::GetActionResultRequest request;
    request.set_instance_name("main");
    re::ActionResult out;
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
    *request.mutable_action_digest() = digest(named("a"));
    request.set_digest_function(re::DigestFunction::BLAKE3);
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
    request.set_digest_function(re::DigestFunction::SHA256);
    request.set_instance_name("nobody/knows");
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
}

TEST_F(Grpc, WalksATree) {
    start();
    const auto keep = [&](const re::Directory& d) {
        const std::string bytes = d.SerializeAsString();
        EXPECT_EQ(put(digest(named(bytes)), bytes), StatusCode::OK);
        return named(bytes);
    };
    re::Directory leaf, middle, root;
    leaf.add_files()->set_name("f");
    const BlobName leaf_name = keep(leaf);
    auto& node = *middle.add_directories();
    node.set_name("leaf");
    *node.mutable_digest() = digest(leaf_name);
    const BlobName middle_name = keep(middle);
    for (const char* where : {"a", "b"}) {  // the same one twice, and one that nobody stored
        auto& below = *root.add_directories();
        below.set_name(where);
        *below.mutable_digest() = digest(middle_name);
    }
    *root.add_directories()->mutable_digest() = digest(named("gone"));
    const BlobName root_name = keep(root);
    const auto walk = [&](const BlobName& from, int& directories) {
        re::GetTreeRequest request;
        request.set_instance_name("main");
        *request.mutable_root_digest() = digest(from);
        const auto held = context();
        auto reader = blobs_->GetTree(held.get(), request);
        re::GetTreeResponse page;
        directories = 0;
        while (reader->Read(&page)) directories += page.directories_size();
        return reader->Finish().error_code();
    };
    int directories = 0;
    EXPECT_EQ(walk(root_name, directories), StatusCode::OK);
    EXPECT_EQ(directories, 3);
    EXPECT_EQ(walk(named("gone"), directories), StatusCode::NOT_FOUND);
}

// Every call with every kind of caller: what it may, and the code of what it may not.
TEST_F(Grpc, ChecksRolesOnEveryCall) {
    start({}, tokens);
    as("cccccccccccccccccccc");
    const BlobName blob = named("a blob"), key = named("a key");
    ASSERT_EQ(put(digest(blob), "a blob"), StatusCode::OK);
    ASSERT_EQ(put_action(key, result(blob)), StatusCode::OK);
    constexpr StatusCode ok = StatusCode::OK, who = StatusCode::UNAUTHENTICATED, no = StatusCode::PERMISSION_DENIED;
    struct Row {
        const char* token;
        StatusCode reads, writes_blobs, writes_actions;
    };
    for (const Row& row : {Row{"", who, who, who}, Row{"an unknown token....", who, who, who},
                           Row{"rrrrrrrrrrrrrrrrrrrr", ok, no, no}, Row{"bbbbbbbbbbbbbbbbbbbb", ok, ok, no},
                           Row{"cccccccccccccccccccc", ok, ok, ok}, Row{"pppppppppppppppppppp", no, no, no}}) {
        as(row.token);
        const std::string mine = std::string("written by ") + row.token;
        std::string out;
        re::FindMissingBlobsRequest find;
        find.set_instance_name("main");
        re::FindMissingBlobsResponse found;
        EXPECT_EQ(blobs_->FindMissingBlobs(context().get(), find, &found).error_code(), row.reads) << row.token;
        re::BatchReadBlobsRequest read;
        read.set_instance_name("main");
        re::BatchReadBlobsResponse got;
        EXPECT_EQ(blobs_->BatchReadBlobs(context().get(), read, &got).error_code(), row.reads) << row.token;
        re::GetCapabilitiesRequest ask;
        ask.set_instance_name("main");
        re::ServerCapabilities can;
        EXPECT_EQ(capabilities_->GetCapabilities(context().get(), ask, &can).error_code(), row.reads) << row.token;
        EXPECT_EQ(download(read_name("main", blob), out).error_code(), row.reads) << row.token;
        EXPECT_EQ(get_action(key), row.reads) << row.token;
        EXPECT_EQ(put(digest(named(mine)), mine), row.writes_blobs) << row.token;
        const std::string streamed = mine + " in a stream";
        EXPECT_EQ(upload({upload_name("main", "u", named(streamed)), streamed}).error_code(), row.writes_blobs) << row.token;
        EXPECT_EQ(put_action(named(mine), result(blob)), row.writes_actions) << row.token;
    }
    // A pull request reads main, and what it writes is its own.
    as("pppppppppppppppppppp");
    instance_ = "pr/7";
    EXPECT_EQ(get_action(key), ok);
    EXPECT_EQ(put_action(named("new"), result(blob)), ok);
    as("cccccccccccccccccccc");
    instance_ = "main";
    EXPECT_EQ(get_action(named("new")), StatusCode::NOT_FOUND);
}

TEST_F(Grpc, ServesManyAtOnce) {
    start();
    std::vector<std::thread> threads;
    std::atomic<int> failures{0};
    for (int t = 0; t < 8; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 20; ++i) {
                const std::string bytes = "blob " + std::to_string((t + i) % 10) + std::string(70'000, 's');
                if (!upload({upload_name("main", std::to_string(t), named(bytes)), bytes}).ok()) ++failures;
                std::string out;
                if (!download(read_name("main", named(bytes)), out).ok() || out != bytes) ++failures;
            }
        });
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(store_->stats()->blob.entries, 10u);
    server_.reset();  // a client hears of a call's end before the call is taken apart
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, LogsEveryCallWithoutItsToken) {
    start({}, tokens);
    as("cccccccccccccccccccc");
    ASSERT_EQ(put(digest(named("a blob")), "a blob"), StatusCode::OK);
    std::string out;
    ASSERT_TRUE(upload({upload_name("main", "u", named("in a stream")), "in a stream"}).ok());
    ASSERT_TRUE(download(read_name("main", named("in a stream")), out).ok());
    re::BatchReadBlobsRequest read;
    read.set_instance_name("main");
    *read.add_digests() = digest(named("a blob"));
    re::BatchReadBlobsResponse got;
    ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), read, &got).ok());
    as("a wrong token, logged?");
    instance_ = "main\"\n{\"forged\":1}";
    EXPECT_EQ(get_action(named("x")), StatusCode::UNAUTHENTICATED);
    server_.reset();
    log_.flush();
    const std::string log = read_file(log_file_);
    ::unlink(log_file_.c_str());
    const auto lines = [&](const std::string& wanted) {
        size_t count = 0;
        for (size_t at = 0, end = 0; (end = log.find('\n', at)) != std::string::npos; at = end + 1)
            count += log.substr(at, end - at).find(wanted) != std::string::npos ? 1 : 0;
        return count;
    };
    EXPECT_EQ(lines(""), 5u) << log;
    for (const char* method : {"BatchUpdateBlobs", "Write", "Read", "BatchReadBlobs"})
        EXPECT_EQ(lines("\"caller\":\"ci\",\"method\":\"" + std::string(method) + "\",\"path\":\"main"), 1u) << method << log;
    EXPECT_EQ(lines("\"method\":\"Read\",\"path\":\"" + read_name("main", named("in a stream")) +
                    "\",\"grpc_status\":0,\"in\":0,\"out\":11"),
              1u)
        << log;
    EXPECT_EQ(lines("\"caller\":\"nobody\",\"method\":\"GetActionResult\",\"path\":\"main\\\"\\u000a{"), 1u) << log;
    EXPECT_EQ(lines("\"grpc_status\":16"), 1u) << log;
    EXPECT_EQ(lines("\"peer\":\"127.0.0.1:"), 5u) << log;
    EXPECT_EQ(log.find("cccccccc"), std::string::npos);
    EXPECT_EQ(log.find("wrong token"), std::string::npos);
}

TEST_F(Grpc, SaysThatItIsWellAndWhatItDoesNotDo) {
    start();
    const auto health = grpc::health::v1::Health::NewStub(channel_);
    grpc::health::v1::HealthCheckRequest ask;
    grpc::health::v1::HealthCheckResponse state;
    ASSERT_TRUE(health->Check(context().get(), ask, &state).ok());
    EXPECT_EQ(state.status(), grpc::health::v1::HealthCheckResponse::SERVING);
    ask.set_service("another");
    EXPECT_EQ(health->Check(context().get(), ask, &state).error_code(), StatusCode::NOT_FOUND);
    const auto execution = re::Execution::NewStub(channel_);
    const auto held = context();
    auto operations = execution->Execute(held.get(), {});
    EXPECT_EQ(operations->Finish().error_code(), StatusCode::UNIMPLEMENTED);
}

// Calls that are under way when the server stops: those that can end do, the others are cut when patience is over.
TEST_F(Grpc, DrainsItsCalls) {
    start();
    bs::WriteResponse response;
    const auto held = context();
    auto writer = streams_->Write(held.get(), &response);
    bs::WriteRequest request;
    request.set_resource_name(upload_name("main", "u", named("abc")));
    request.set_data("a");
    ASSERT_TRUE(writer->Write(request));
    while (service_->in_flight() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::thread drain([&] { server_->drain(std::chrono::seconds(60)); });
    request.set_data("bc");
    request.set_write_offset(1);
    request.set_finish_write(true);
    EXPECT_TRUE(writer->Write(request));
    EXPECT_TRUE(writer->Finish().ok());
    drain.join();
    EXPECT_TRUE(*service_->has_blob(Caller::trusted(), "main", named("abc")));

    start();
    const auto other = context();
    writer = streams_->Write(other.get(), &response);
    request.set_resource_name(upload_name("main", "u", named("xyz")));
    request.set_write_offset(0);
    request.set_finish_write(false);
    ASSERT_TRUE(writer->Write(request));
    while (service_->in_flight() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    server_->drain(std::chrono::seconds(0));
    EXPECT_FALSE(writer->Finish().ok());
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, AFrontThatCannotListenSaysSo) {
    start();
    GrpcOptions taken;
    taken.port = server_->port();
    EXPECT_FALSE(GrpcServer::start(
                     *service_, log_, [this] { return access_; }, taken)
                     .ok());
    GrpcOptions tls;
    tls.certificate = tls.key = folder_.path() + "/no such file";
    EXPECT_FALSE(GrpcServer::start(
                     *service_, log_, [this] { return access_; }, tls)
                     .ok());
}

TEST_F(Grpc, SpeaksTlsToWhoTrustsItsCertificate) {
    GrpcOptions options;
    options.certificate = folder_.path() + "/cert.pem";
    options.key = folder_.path() + "/key.pem";
    options.look_again = std::chrono::seconds(1);
    const std::string make =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=localhost "
        "-addext subjectAltName=IP:127.0.0.1 -keyout " +
        options.key + " -out " + options.certificate + " 2>/dev/null";
    ASSERT_EQ(std::system(make.c_str()), 0);
    start(options);
    const auto ask = [&](const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
        capabilities_ =
            re::Capabilities::NewStub(grpc::CreateChannel("127.0.0.1:" + std::to_string(server_->port()), credentials));
        re::GetCapabilitiesRequest request;
        request.set_instance_name("main");
        re::ServerCapabilities out;
        return capabilities_->GetCapabilities(context().get(), request, &out).error_code();
    };
    grpc::SslCredentialsOptions trust;
    trust.pem_root_certs = read_file(options.certificate);
    EXPECT_EQ(ask(grpc::SslCredentials(trust)), StatusCode::OK);
    EXPECT_EQ(ask(grpc::SslCredentials({})), StatusCode::UNAVAILABLE);
    EXPECT_EQ(ask(grpc::InsecureChannelCredentials()), StatusCode::UNAVAILABLE);
    // A new certificate is served to new connections without a restart.
    ASSERT_EQ(std::system(make.c_str()), 0);
    trust.pem_root_certs = read_file(options.certificate);
    StatusCode got = StatusCode::UNKNOWN;
    for (int i = 0; i < 150 && got != StatusCode::OK; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        got = ask(grpc::SslCredentials(trust));
    }
    EXPECT_EQ(got, StatusCode::OK);
}

TEST(ResourceName, ReadsAndWritesTheFourForms) {
    const BlobName blob = named("x");
    const std::string hash = blob.digest.hex();
    EXPECT_EQ(parse_resource_name(read_name("", blob)), (ResourceName{"", false, false, blob}));
    EXPECT_EQ(parse_resource_name(read_name("a/b", blob)), (ResourceName{"a/b", false, false, blob}));
    EXPECT_EQ(parse_resource_name(upload_name("", "u", blob)), (ResourceName{"", true, false, blob}));
    EXPECT_EQ(parse_resource_name(upload_name("a", "u", blob) + "/some/file.txt"), (ResourceName{"a", true, false, blob}));
    EXPECT_EQ(parse_resource_name("compressed-blobs/zstd/" + hash + "/1"), (ResourceName{"", false, true, blob}));
    EXPECT_EQ(parse_resource_name("i/uploads/u/compressed-blobs/zstd/" + hash + "/1"), (ResourceName{"i", true, true, blob}));
    for (const std::string& bad :
         {std::string(), std::string("blobs"), "blobs/" + hash, "blobs/" + hash + "/", "blobs/" + hash + "/-1",
          "blobs/" + hash + "/+1", "blobs/" + hash + "/1x", "blobs/" + hash + "/99999999999999999999", std::string("blobs//1"),
          "uploads/blobs/" + hash + "/1", "uploads//blobs/" + hash + "/1", "compressed-blobs/" + hash + "/1",
          "compressed-blobs/deflate/" + hash + "/1", "uploads/u/" + hash + "/1", hash + "/1",
          std::string(2000, 'a') + "/blobs/" + hash + "/1"})
        EXPECT_FALSE(parse_resource_name(bad)) << bad;
}

}  // namespace
}  // namespace kiln
