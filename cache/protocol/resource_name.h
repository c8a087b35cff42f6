#pragma once
// The names by which ByteStream calls a blob:
//
//     [INSTANCE/]blobs/HASH/SIZE[/…]                           to read
//     [INSTANCE/]compressed-blobs/zstd/HASH/SIZE[/…]
//     [INSTANCE/]uploads/UUID/blobs/HASH/SIZE[/…]              to write
//     [INSTANCE/]uploads/UUID/compressed-blobs/zstd/HASH/SIZE[/…]
//
// HASH is 64 lower-case hex digits. An instance has no segment among those words, so the first of them ends it.

#include <optional>
#include <string>
#include <string_view>

#include "cache/protocol/blob_name.h"

namespace kiln {

struct ResourceName {
    std::string instance;
    bool upload = false;
    bool zstd = false;  // the bytes on the wire are compressed; `blob` names what they are without it
    BlobName blob;
    friend bool operator==(const ResourceName&, const ResourceName&) = default;
};

// nullopt: no such name, or a compressor that is not zstd.
std::optional<ResourceName> parse_resource_name(std::string_view name);
std::string read_name(std::string_view instance, const BlobName& blob);
// `uuid` tells one upload from another; any text without '/'.
std::string upload_name(std::string_view instance, std::string_view uuid, const BlobName& blob);

// As both protocols write a digest: 64 lower-case hex digits and a size of at most 2^63 - 1.
std::optional<BlobName> blob_name(std::string_view hash, int64_t size);

}  // namespace kiln
