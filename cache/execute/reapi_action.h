#pragma once
// A job as the Remote Execution API names it. Included by the gRPC module's sources alone.

#include <remote_execution.grpc.pb.h>

#include <map>

#include "cache/execute/reapi_engine.h"
#include "cache/protocol/blob_name.h"

namespace kiln {

namespace reapi = build::bazel::remote::execution::v2;

struct ReapiAction {
    BlobName name;  // of the Action message
    // All that the node must hold: messages, which are here, and input files, whose bytes belong to the job.
    std::map<Digest, ByteView> blobs;
    std::vector<std::shared_ptr<const Bytes>> owned;
};

// Equal jobs give equal names, whatever the order of their inputs. An Error when a path leaves the folder, or two inputs clash.
Result<ReapiAction> reapi_action(const Job& job, const std::vector<std::pair<std::string, std::string>>& platform);

void set_digest(reapi::Digest* out, const BlobName& name);

}  // namespace kiln
