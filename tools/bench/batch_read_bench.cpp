// Blobs a second through BatchReadBlobs, from one server of the Remote Execution API: batch_read_bench fill|read HOST:PORT SIZE
// BATCH CONNECTIONS SECONDS. `fill` uploads what `read` asks for. A connection has one caller, who asks when he has been
// answered. Every blob that comes back is compared with what was sent.

#include <grpcpp/grpcpp.h>
#include <remote_execution.grpc.pb.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "compiler/base/digest.h"

namespace {

namespace reapi = build::bazel::remote::execution::v2;
using Clock = std::chrono::steady_clock;

constexpr size_t blobs = 1000;

std::string blob(size_t index, size_t size) {
    std::string out = std::to_string(index) + " ";
    uint64_t state = index + 1;
    while (out.size() < size) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        out += static_cast<char>(state >> 56);
    }
    out.resize(size);
    return out;
}

int fail(const grpc::Status& status) {
    std::fprintf(stderr, "gRPC status %d: %s\n", static_cast<int>(status.error_code()), status.error_message().c_str());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 7) return std::fputs("usage: batch_read_bench fill|read HOST:PORT SIZE BATCH CONNECTIONS SECONDS\n", stderr), 2;
    const bool fill = std::string(argv[1]) == "fill";
    const size_t size = std::strtoul(argv[3], nullptr, 10), batch = std::strtoul(argv[4], nullptr, 10);
    const size_t connections = std::strtoul(argv[5], nullptr, 10);
    const double seconds = std::strtod(argv[6], nullptr);
    std::vector<std::string> texts;
    std::vector<reapi::Digest> names;
    for (size_t i = 0; i < blobs; ++i) {
        texts.push_back(blob(i, size));
        names.emplace_back();
        names.back().set_hash(kiln::sha256(kiln::as_bytes(texts.back())).hex());
        names.back().set_size_bytes(static_cast<int64_t>(size));
    }
    const auto connect = [&] {
        grpc::ChannelArguments own;
        own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
        return reapi::ContentAddressableStorage::NewStub(
            grpc::CreateCustomChannel(argv[2], grpc::InsecureChannelCredentials(), own));
    };
    if (fill) {
        const auto stub = connect();
        for (size_t at = 0; at < blobs;) {
            reapi::BatchUpdateBlobsRequest request;
            for (size_t bytes = 0; at < blobs && bytes + size < 3'000'000; bytes += size + 100, ++at) {
                auto& one = *request.add_requests();
                *one.mutable_digest() = names[at];
                one.set_data(texts[at]);
            }
            reapi::BatchUpdateBlobsResponse response;
            grpc::ClientContext context;
            const grpc::Status status = stub->BatchUpdateBlobs(&context, request, &response);
            if (!status.ok()) return fail(status);
            for (const auto& one : response.responses())
                if (one.status().code() != 0) return std::fprintf(stderr, "not stored: %s\n", one.status().message().c_str()), 1;
        }
        return 0;
    }
    std::atomic<uint64_t> done{0}, wrong{0};
    const auto start = Clock::now(),
               end = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    const auto work = [&](size_t caller) {
        const auto stub = connect();
        for (size_t at = caller * 37; Clock::now() < end; at += batch) {
            reapi::BatchReadBlobsRequest request;
            for (size_t i = 0; i < batch; ++i) *request.add_digests() = names[(at + i) % blobs];
            reapi::BatchReadBlobsResponse response;
            grpc::ClientContext context;
            const grpc::Status status = stub->BatchReadBlobs(&context, request, &response);
            if (!status.ok() || response.responses_size() != static_cast<int>(batch)) {
                ++wrong;
                return;
            }
            for (const auto& one : response.responses()) {
                const auto index = std::strtoul(one.data().c_str(), nullptr, 10);
                if (index < blobs && one.data() == texts[index] && one.digest().hash() == names[index].hash())
                    ++done;
                else
                    ++wrong;
            }
        }
    };
    std::vector<std::thread> threads;
    for (size_t i = 0; i < connections; ++i) threads.emplace_back(work, i);
    for (std::thread& t : threads) t.join();
    const double took = std::chrono::duration<double>(Clock::now() - start).count();
    std::printf("%.0f\n", static_cast<double>(done) / took);
    return wrong == 0 ? 0 : 1;
}
