#pragma once
// BatchReadBlobs without a message object: the response is a list of pieces, of which a blob's is the memory that holds it
// already or that its file was read into, so that no byte of it is copied before the socket.

#include "cache/server/grpc_call.h"

namespace kiln {

// Parses `request` and fills `response`, both as they are on the wire. A blob that is missing or cannot be read has a status
// of its own; a batch that is malformed, too large or not the caller's to read is refused as a whole.
grpc::Status batch_read(CallContext& shared, const Caller& caller, grpc::ByteBuffer& request, grpc::ByteBuffer& response);

}  // namespace kiln
