#pragma once
// The mark that an index was closed and not altered since, little-endian:
//
//     clean = magic:8 "kilnidx1"  size:8  sum:16  check:16
//
// sum is XXH3-128 of the XXH3-128s of each MiB of the file, check of all that stands before it.

#include <optional>
#include <string>

#include "compiler/base/bytes.h"
#include "compiler/base/digest.h"

namespace kiln {

struct CleanMark {
    uint64_t size = 0;
    Fast sum;
    friend bool operator==(const CleanMark&, const CleanMark&) = default;
};

Bytes write_mark(const CleanMark& mark);
std::optional<CleanMark> read_mark(ByteView bytes);

std::string clean_file(const std::string& folder);
bool is_clean(const std::string& folder, const std::string& data);
void mark_clean(const std::string& folder, const std::string& data);  // where it fails, the next user scans

}  // namespace kiln
