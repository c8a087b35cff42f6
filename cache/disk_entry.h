#pragma once
// The frame of an action record on disk, little-endian:
//
//     record = magic:8 "kilnact1"  key:32  size:8  checksum:16  payload:size
//
// checksum is XXH3-128 (low, high) of key, size and the XXH3-128 of the payload. It finds damage, not malice: whoever can
// write the folder can write a good checksum. The key inside makes a record that was moved or copied to another name a miss.

#include <optional>
#include <string>

#include "compiler/base/store.h"

namespace kiln {

constexpr size_t action_head_size = 64;

Bytes action_head(const Digest& key, ByteView payload);
// The payload, or nullopt when `file` is not exactly one undamaged record for `key`.
std::optional<ByteView> action_payload(const Digest& key, ByteView file);

// Empty when `file` is what an entry of that name holds; else what is wrong with it, for a person.
std::string entry_problem(Keyspace space, const Digest& key, ByteView file);

}  // namespace kiln
