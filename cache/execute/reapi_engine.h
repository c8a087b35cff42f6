#pragma once
// An Engine over the Remote Execution API v2: jobs run on the nodes of an engine that is there already (buildbox-casd, or any
// other). It lives in the module that holds the gRPC client (grpc_remote.h).
//
// A job becomes an Action: a Merkle tree of its inputs, its command, and no name, time or path of this machine, so that equal
// jobs are equal actions everywhere. Blobs that a node lacks are sent before; one that it misses all the same (it lost it
// between) is sent again, once. A cached result whose outputs are gone, or that is a failure, is made anew, once. What nobody
// waits for any more, after an interruption or at the deadline, is cancelled where the engine offers that.
//
// Nothing that comes back is believed: outputs are verified against their digests, and are files under the names that were
// asked for; a result with a path that leaves its folder is refused whole. Nodes are taken in turn; what one of them cannot be
// reached for, or fails at by its own fault, is asked of the next, and that node is left alone for a while. One that says nothing
// while it works is asked for its capabilities now and then, and counts as gone when it does not answer.

#include "cache/client/grpc_remote.h"
#include "cache/execute/engine.h"

namespace kiln {

struct ReapiOptions {
    GrpcRemoteOptions remote;  // token, authority; `timeout` is that of one call that moves blobs
    std::vector<std::pair<std::string, std::string>> platform;  // what a worker must have, by the engine's own names
    size_t width = 4;                                           // jobs at a time on each node
    std::chrono::milliseconds rest{10'000};                     // of a node that could not be reached
    std::chrono::milliseconds silence{15'000};                  // of a node at work, before it is asked whether it is there
};

using OpenReapiEngine = Result<std::unique_ptr<Engine>>(std::span<const RemoteUrl>, const ReapiOptions&);
constexpr const char* reapi_module_symbol = "kiln_grpc_open_engine_2";

// The nodes' blobs and executions are at the same address, and the path of each is its instance. An Error where the module is
// not installed or there is no node.
Result<std::unique_ptr<Engine>> open_reapi_engine(std::span<const RemoteUrl> nodes, const ReapiOptions& options);

}  // namespace kiln
