// The end of the front, whatever its calls are doing.
#include "tests/unit/server_grpc/front.h"

namespace kiln {
namespace {

// Many short calls and an end at once: some have come to gRPC and not yet to the front.
TEST_F(Grpc, EndsAmongCallsThatHaveJustCome) {
    for (int round = 0; round < 20; ++round) {
        start();
        std::atomic<bool> stop{false};
        std::atomic<int> served{0};
        std::vector<std::thread> clients;
        for (int c = 0; c < 3; ++c)
            clients.emplace_back([&] {
                while (!stop) {
                    std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
                    grpc::CompletionQueue queue;
                    re::GetCapabilitiesRequest request;
                    request.set_instance_name("main");
                    constexpr int many = 64;
                    re::ServerCapabilities out[many];
                    grpc::Status status[many];
                    for (int i = 0; i < many; ++i) {
                        contexts.push_back(context());
                        capabilities_->AsyncGetCapabilities(contexts.back().get(), request, &queue)
                            ->Finish(&out[i], &status[i], nullptr);
                    }
                    void* tag = nullptr;
                    bool ok = false;
                    for (int i = 0; i < many; ++i) queue.Next(&tag, &ok);
                    for (const grpc::Status& one : status) served += one.ok() ? 1 : 0;
                    queue.Shutdown();
                    while (queue.Next(&tag, &ok)) {
                    }
                }
            });
        while (served < 50) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        server_->drain(std::chrono::seconds(0));
        stop = true;
        for (std::thread& client : clients) client.join();
        EXPECT_EQ(service_->answering(), 0u);
    }
}

// A disk that is slow, calls that ask it much, and others in line behind them.
TEST_F(Grpc, CutsCallsThatWaitForTheDisk) {
    GrpcOptions options;
    options.work_threads = 2;
    start(options);
    Chaos slow;
    slow.delay = 100;
    service_->hurt(slow, "");
    constexpr uint64_t clients = 12, each = 200;
    const auto find = [&] {
        re::FindMissingBlobsRequest request;
        request.set_instance_name("main");
        for (uint64_t i = 0; i < each; ++i) *request.add_blob_digests() = digest(named(std::to_string(i)));
        re::FindMissingBlobsResponse response;
        return blobs_->FindMissingBlobs(context().get(), request, &response);
    };
    const auto update = [&] {
        re::BatchUpdateBlobsRequest request;
        request.set_instance_name("main");
        for (uint64_t i = 0; i < each; ++i) {
            auto& one = *request.add_requests();
            one.set_data(std::to_string(i));
            *one.mutable_digest() = digest(named(one.data()));
        }
        re::BatchUpdateBlobsResponse response;
        return blobs_->BatchUpdateBlobs(context().get(), request, &response);
    };
    const auto read = [&] {
        re::BatchReadBlobsRequest request;
        request.set_instance_name("main");
        for (uint64_t i = 0; i < 2 * each; ++i) *request.add_digests() = digest(named(std::to_string(i)));
        re::BatchReadBlobsResponse response;
        return blobs_->BatchReadBlobs(context().get(), request, &response);
    };
    const std::vector<std::function<grpc::Status()>> kinds{find, update, read};
    for (const auto& kind : kinds) {
        std::vector<std::thread> threads;
        std::atomic<uint64_t> cut{0};
        for (uint64_t i = 0; i < clients; ++i) threads.emplace_back([&] { cut += kind().ok() ? 0 : 1; });
        while (service_->mishaps().counters().delayed < 4) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        server_->drain(std::chrono::seconds(0));
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(cut, clients);
        EXPECT_LT(service_->mishaps().counters().delayed, each);  // not one of the calls was done
        EXPECT_EQ(service_->in_flight() + service_->answering(), 0u);
        start(options);
        service_->hurt(slow, "");
    }
}

}  // namespace
}  // namespace kiln
