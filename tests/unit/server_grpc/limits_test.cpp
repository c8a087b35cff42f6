// What a client may make the server hold.
#include <google/protobuf/message.h>
#include <grpcpp/generic/generic_stub.h>

#include <tuple>

#include "cache/disk_folder.h"
#include "tests/unit/server_grpc/front.h"

namespace kiln {
namespace {

std::string noise(size_t size) {
    std::string out(size, '\0');
    uint64_t state = 1;
    for (char& c : out) c = static_cast<char>((state = state * 6364136223846793005u + 1442695040888963407u) >> 56);
    return out;
}

// More than the sockets between hold; and a client that takes 64 KiB at a time.
constexpr size_t large = 16'000'000;

std::unique_ptr<bs::ByteStream::Stub> slow_reader(uint16_t port) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
    arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 65'535);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return bs::ByteStream::NewStub(
        grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials(), arguments));
}

TEST_F(Grpc, HoldsNoMoreForSlowReadersThanItsShare) {
    ServiceLimits limits;
    limits.in_flight = 20'000'000;
    start({}, nullptr, limits);
    const std::string bytes = noise(large);
    ASSERT_TRUE(upload({upload_name("main", "u", named(bytes)), bytes}).ok());
    const std::string name = "main/compressed-blobs/zstd/" + named(bytes).digest.hex() + "/" + std::to_string(bytes.size());
    bs::ReadRequest request;
    request.set_resource_name(name);
    const auto held = context();
    const auto stub = slow_reader(server_->port());
    auto slow = stub->Read(held.get(), request);
    for (int i = 0; i < 500 && service_->answering() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(service_->answering(), large);
    std::string out;
    EXPECT_EQ(download(name, out).error_code(), StatusCode::UNAVAILABLE);
    bs::ReadResponse response;
    while (slow->Read(&response)) {
    }
    EXPECT_TRUE(slow->Finish().ok());
    for (int i = 0; i < 500 && service_->answering() != 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(download(name, out).ok());
}

TEST_F(Grpc, EndsAnAnswerThatNobodyReads) {
    GrpcOptions options;
    options.patience = std::chrono::seconds(1);
    options.slowest = 1 << 30;
    start(options);
    const std::string bytes = noise(large);
    ASSERT_TRUE(upload({upload_name("main", "u", named(bytes)), bytes}).ok());
    bs::ReadRequest request;
    request.set_resource_name(read_name("main", named(bytes)));
    const auto held = context();
    const auto stub = slow_reader(server_->port());
    auto slow = stub->Read(held.get(), request);
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    bs::ReadResponse response;
    while (slow->Read(&response)) {
    }
    EXPECT_EQ(slow->Finish().error_code(), StatusCode::CANCELLED);  // by the server
    EXPECT_EQ(service_->answering(), 0u);
    std::string out;
    EXPECT_TRUE(download(read_name("main", named(bytes)), out).ok());
}

TEST_F(Grpc, AMessageNamesNoMoreThanItsLimit) {
    start();
    re::FindMissingBlobsRequest find;
    re::BatchReadBlobsRequest read;
    re::BatchUpdateBlobsRequest update;
    re::FindMissingBlobsResponse found;
    re::BatchReadBlobsResponse got;
    re::BatchUpdateBlobsResponse kept;
    for (auto* request : {static_cast<google::protobuf::Message*>(&find), static_cast<google::protobuf::Message*>(&read),
                          static_cast<google::protobuf::Message*>(&update)})
        request->GetReflection()->SetString(request, request->GetDescriptor()->FindFieldByName("instance_name"), "main");
    const auto more = [&](int count) {
        for (int i = 0; i < count; ++i) {
            *find.add_blob_digests() = *read.add_digests() = digest(named(""));
            *update.add_requests()->mutable_digest() = digest(named(""));
        }
        return std::vector<grpc::Status>{blobs_->FindMissingBlobs(context().get(), find, &found),
                                         blobs_->BatchReadBlobs(context().get(), read, &got),
                                         blobs_->BatchUpdateBlobs(context().get(), update, &kept)};
    };
    for (const grpc::Status& status : more(32'768)) EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(kept.responses_size(), 32'768);
    EXPECT_EQ(got.responses_size(), 32'768);
    for (const grpc::Status& status : more(1)) EXPECT_EQ(status.error_message(), "more blobs than one message may name");
    find.clear_blob_digests();
    for (int i = 0; i < 2'000'000; ++i) find.add_blob_digests();
    EXPECT_EQ(more(0).front().error_message(), "more blobs than one message may name");
    // As many as it takes that are not there, which the client is told of each.
    read.clear_digests();
    for (int i = 0; i < 32'768; ++i) *read.add_digests() = digest({named(std::to_string(i)).digest, 100});
    ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), read, &got).ok());
    EXPECT_EQ(got.responses_size(), 32'768);
    EXPECT_EQ(got.responses(32'767).status().code(), StatusCode::NOT_FOUND);
}

// A call of any method whose answer nobody reads.
class Unread {
public:
    Unread(uint16_t port, const std::string& method, const google::protobuf::Message& request) {
        grpc::ChannelArguments arguments;
        arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
        arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 65'535);
        stub_ = std::make_unique<grpc::GenericStub>(
            grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials(), arguments));
        call_ = stub_->PrepareCall(&context_, "/build.bazel.remote.execution.v2.ContentAddressableStorage/" + method, &queue_);
        const grpc::Slice bytes(request.SerializeAsString());
        call_->StartCall(this);
        wait();
        call_->Write(grpc::ByteBuffer(&bytes, 1), this);
        wait();
        call_->WritesDone(this);
        wait();
    }
    ~Unread() {
        context_.TryCancel();
        grpc::Status status;
        call_->Finish(&status, this);
        wait();
    }

private:
    void wait() {
        void* tag = nullptr;
        bool ok = false;
        queue_.Next(&tag, &ok);
    }
    grpc::CompletionQueue queue_;
    grpc::ClientContext context_;
    std::unique_ptr<grpc::GenericStub> stub_;
    std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
};

TEST_F(Grpc, EveryAnswerIsHeldWithinTheShareAndEndedInTime) {
    GrpcOptions options;
    options.patience = std::chrono::seconds(2);
    options.slowest = 1 << 30;
    start(options);
    re::Directory root;
    for (int i = 0; i < 9'000; ++i) {
        auto& file = *root.add_files();
        file.set_name(std::to_string(i));
        *file.mutable_digest() = digest(named(std::to_string(i)));
    }
    const std::string tree = root.SerializeAsString();
    const std::string bytes = noise(3'000'000);
    ASSERT_EQ(put(digest(named(tree)), tree), StatusCode::OK);
    ASSERT_EQ(put(digest(named(bytes)), bytes), StatusCode::OK);

    re::FindMissingBlobsRequest find;
    find.set_instance_name("main");
    for (int i = 0; i < 20'000; ++i) *find.add_blob_digests() = digest(named(std::to_string(i)));
    re::BatchReadBlobsRequest read;
    read.set_instance_name("main");
    *read.add_digests() = digest(named(bytes));
    re::BatchReadBlobsRequest absent;  // blobs that are not there: what is said of them is held as well
    absent.set_instance_name("main");
    for (int i = 0; i < 20'000; ++i) *absent.add_digests() = digest(named(std::to_string(i)));
    re::GetTreeRequest walk;
    walk.set_instance_name("main");
    *walk.mutable_root_digest() = digest(named(tree));
    const std::vector<std::tuple<const char*, const google::protobuf::Message*, uint64_t>> calls{
        {"FindMissingBlobs", &find, 20'000 * 70},
        {"BatchReadBlobs", &read, bytes.size()},
        {"BatchReadBlobs", &absent, 20'000 * 95},
        {"GetTree", &walk, tree.size()}};
    std::vector<std::unique_ptr<Unread>> unread;
    uint64_t least_of_all = 0;
    for (const auto& [method, request, least] : calls) {
        unread.push_back(std::make_unique<Unread>(server_->port(), method, *request));
        least_of_all += least;
    }
    for (int i = 0; i < 2000 && (service_->answering() < least_of_all || service_->in_flight() != 0); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_GE(service_->answering(), least_of_all);
    EXPECT_EQ(service_->in_flight(), 0u);  // the questions are not held any more
    for (int i = 0; i < 1000 && service_->answering() != 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(service_->answering(), 0u);
}

// Messages that wait for a slow disk are bodies like others; and who may not ask does not wait for it.
TEST_F(Grpc, HoldsNoMoreOfWhatWaitsThanItsShare) {
    GrpcOptions options;
    options.work_threads = 1;
    ServiceLimits limits;
    limits.in_flight = 64'000'000;
    start(options, tokens, limits);
    Chaos slow;
    slow.delay = 60;
    service_->hurt(slow, "");
    as("cccccccccccccccccccc");
    std::vector<std::thread> clients;
    std::atomic<int> kept{0}, busy{0}, shed{0};  // shed: by gRPC itself, which has the same limit
    for (int i = 0; i < 40; ++i)
        clients.emplace_back([&, i] {
            const std::string bytes = std::to_string(i) + std::string(3'500'000, 'u');
            const StatusCode got = put(digest(named(bytes)), bytes);
            kept += got == StatusCode::OK ? 1 : 0;
            busy += got == StatusCode::UNAVAILABLE ? 1 : 0;
            shed += got == StatusCode::RESOURCE_EXHAUSTED ? 1 : 0;
        });
    for (std::thread& client : clients) client.join();
    EXPECT_EQ(kept + busy + shed, 40);
    EXPECT_GE(kept, 4);
    EXPECT_GE(busy, 1);

    std::atomic<bool> over{false};
    std::thread first([&] {
        re::FindMissingBlobsRequest request;
        request.set_instance_name("main");
        for (int i = 0; i < 1000; ++i) *request.add_blob_digests() = digest(named(std::to_string(i)));
        re::FindMissingBlobsResponse response;
        EXPECT_EQ(blobs_->FindMissingBlobs(context().get(), request, &response).error_code(), StatusCode::UNAVAILABLE);
        over = true;
    });
    for (const uint64_t before = service_->mishaps().counters().delayed; service_->mishaps().counters().delayed < before + 2;)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    token_ = "Bearer no such token at all";
    std::string out;
    EXPECT_EQ(get_action(named("x")), StatusCode::UNAUTHENTICATED);
    EXPECT_EQ(put(digest(named("x")), "x"), StatusCode::UNAUTHENTICATED);
    EXPECT_EQ(download(read_name("main", named("x")), out).error_code(), StatusCode::UNAUTHENTICATED);
    EXPECT_EQ(upload({upload_name("main", "u", named("x")), "x"}).error_code(), StatusCode::UNAUTHENTICATED);
    EXPECT_FALSE(over);
    server_->drain(std::chrono::seconds(0));
    first.join();
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, AnUploadMendsABlobThatWasDamaged) {
    start();
    const std::string bytes = noise(100'000);
    const BlobName name = named(bytes);
    ASSERT_TRUE(upload({upload_name("main", "u", name), bytes}).ok());
    const Descriptor file(::open(path_of(folder_.path(), Keyspace::blob, name.digest).c_str(), O_WRONLY | O_CLOEXEC));
    ASSERT_EQ(::pwrite(file.get(), "xx", 2, 5000), 2);
    int64_t committed = 0;
    EXPECT_TRUE(upload({upload_name("main", "u", name), bytes}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(bytes.size()));
    std::string out;
    EXPECT_TRUE(download(read_name("main", name), out).ok());
    EXPECT_EQ(out, bytes);
}

}  // namespace
}  // namespace kiln
