#pragma once
// SHA-256 of bytes that are never in memory all at once.

#include "compiler/base/digest.h"

namespace kiln {

class StreamHash {
public:
    StreamHash();
    StreamHash(const StreamHash&) = delete;
    StreamHash& operator=(const StreamHash&) = delete;
    ~StreamHash();
    void update(ByteView bytes);
    Digest finish();  // once

private:
    void* state_;
};

}  // namespace kiln
