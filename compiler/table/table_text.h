#pragma once
// Packs texts into LZ4 blocks of the table. The only user of liblz4; the reader decodes by itself.

#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/jobs.h"
#include "compiler/base/result.h"
#include "compiler/runtime/table_format.h"

namespace kiln {

struct PackedTexts {
    std::vector<kf_block_record> blocks;
    std::vector<kf_artifact_record> places;  // one a text, in the order given; `target` is left for the caller
    Bytes bytes;
};

// Texts that are near each other in the list share blocks, so order them by likeness. A block holds several texts up to
// KF_BLOCK_BYTES, or one text of any size below 2 GiB; `breaks[i]` starts a new block before text i.
Result<PackedTexts> pack_texts(const std::vector<const std::string*>& texts, const std::vector<bool>& breaks, const Jobs& jobs);

}  // namespace kiln
