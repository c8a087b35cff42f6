#pragma once
// A RemoteStore over the Remote Execution API v2: blobs in batches, large ones by streams, actions one a call and many at a
// time. It lives in a module of its own (kiln-grpc.so) that is loaded when a grpc:// address is named: linked, gRPC would cost
// every start some fifty libraries, and kiln would not run where they are missing.
//
// A server is bounded as HttpTransfer bounds one: messages of 4 MiB, headers of 64 KiB, streams of the size that was asked,
// deadlines on every call. Messages that say they are compressed are not unpacked; nothing is tried again.

#include <atomic>

#include "cache/client/remote_store.h"
#include "cache/client/remote_url.h"

namespace kiln {

struct GrpcRemoteOptions {
    std::chrono::milliseconds timeout{5000};
    std::string token;                               // empty: none; else sent as a bearer token
    std::string authority;                           // grpcs: PEM; empty: the system's
    const std::atomic<bool>* interrupted = nullptr;  // the program's own: the module has another of that name
    bool inputs = false;  // its blobs are what an engine reads: they are sent whether or not actions may be written
};

// What is asked for is refused where the server's API versions and 2.0 to 2.11 have nothing in common, or without SHA-256.
constexpr int grpc_newest_minor = 11;

using OpenGrpcRemote = Result<std::unique_ptr<RemoteStore>>(const RemoteUrl&, const GrpcRemoteOptions&, const RemoteLimits&);

// The module's one symbol; a change of any type in its signature changes the number.
constexpr const char* grpc_module_symbol = "kiln_grpc_open_2";

// Loads the module that lies beside this program (bin/kiln-grpc.so, or lib/kiln/ of the same installation) and opens a client. An
// Error where there is none.
Result<std::unique_ptr<RemoteStore>> open_grpc_remote(const RemoteUrl& url, const GrpcRemoteOptions& options,
                                                      const RemoteLimits& limits);

}  // namespace kiln
