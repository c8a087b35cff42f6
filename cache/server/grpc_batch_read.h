#pragma once
// BatchReadBlobs without a message object: the response is a list of pieces, of which a blob's is the memory that holds it
// already or that its file was read into, so that no byte of it is copied before the socket.

#include "cache/server/grpc_call.h"

namespace kiln {

// How to ask gRPC for the next call of the method: its context, request, writer, two queues and tag.
using AskForBatchRead =
    std::function<void(grpc::ServerContext*, grpc::ByteBuffer*, grpc::ServerAsyncResponseWriter<grpc::ByteBuffer>*,
                       grpc::CompletionQueue*, grpc::ServerCompletionQueue*, void*)>;

// A blob that is missing or cannot be read has a status of its own; a batch that is malformed, too large or not the caller's to
// read is refused as a whole.
void serve_batch_read(CallContext& shared, grpc::ServerCompletionQueue& queue, const AskForBatchRead& ask);

}  // namespace kiln
