#pragma once
// The Remote Execution API's cache over gRPC: Capabilities, ContentAddressableStorage, ActionCache, ByteStream, and Check of
// gRPC's health protocol. No Execution: an engine brings that and uses this server as its store.
//
// Promises: a message of more than 4 MiB is refused before it is read; an upload is stored when it was finished and matches
// its digest and size, and leaves nothing otherwise; an upload or download that takes longer than its size allows is ended;
// API versions 2.0 to 2.11, SHA-256 alone, zstd or plain.

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "cache/server/log.h"
#include "cache/server/service.h"

namespace kiln {

struct GrpcOptions {
    std::string address = "127.0.0.1";
    uint16_t port = 0;             // 0: the kernel chooses
    std::string certificate, key;  // PEM files; empty: plain text
    // A certificate that was replaced is taken within so long, with no word to the server; a broken one is not.
    std::chrono::seconds look_again{10};
    // What a stream may take in all: this, and its size at `slowest` bytes a second.
    std::chrono::seconds patience{60};
    uint64_t slowest = 64 * 1024;
    // Threads that serve sockets, 0: one for two processors, at most 8; and those that wait for the disk.
    unsigned io_threads = 0, work_threads = 4;
};

constexpr int grpc_most_message = 4 * 1024 * 1024;
// Of the blobs of one batch, so that the message around them passes too.
constexpr int64_t grpc_most_batch = grpc_most_message - 256 * 1024;

struct GrpcCalls;

class GrpcServer {
public:
    // `service` and `log` outlive the server; `access()` gives the tokens of now. An Error when the address cannot be had or the
    // certificate not read.
    static Result<std::unique_ptr<GrpcServer>> start(Service& service, Log& log,
                                                     std::function<std::shared_ptr<const Access>()> access,
                                                     const GrpcOptions& options);
    ~GrpcServer();
    uint16_t port() const;
    // Takes no new calls and ends those that are still running after `patience`.
    void drain(std::chrono::seconds patience);

private:
    explicit GrpcServer(std::unique_ptr<GrpcCalls> calls);
    const std::unique_ptr<GrpcCalls> calls_;
};

}  // namespace kiln
