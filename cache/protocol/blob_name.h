#pragma once
// How the protocols name a blob: by its SHA-256 and its size.

#include "compiler/base/digest.h"

namespace kiln {

struct BlobName {
    Digest digest;
    uint64_t size = 0;
    friend bool operator==(const BlobName&, const BlobName&) = default;
};

}  // namespace kiln
