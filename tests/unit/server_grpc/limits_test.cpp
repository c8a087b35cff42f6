// What a client may make the server hold.
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
    for (const bool many : {false, true}) {
        for (int i = 0; i < (many ? 65'537 : 10); ++i) {
            *find.add_blob_digests() = digest(named(""));
            read.add_digests();
            update.add_requests();
        }
        EXPECT_EQ(blobs_->FindMissingBlobs(context().get(), find, &found).ok(), !many);
        EXPECT_EQ(blobs_->BatchUpdateBlobs(context().get(), update, &kept).ok(), !many);
        EXPECT_EQ(blobs_->BatchReadBlobs(context().get(), read, &got).error_code(), StatusCode::INVALID_ARGUMENT);
    }
    EXPECT_EQ(kept.responses_size(), 10);
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
