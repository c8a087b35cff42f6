#pragma once
// The value of an action in the Remote Execution API v2 (message ActionResult), and the blobs that one needs.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/protocol/blob_name.h"
#include "compiler/base/result.h"

namespace kiln {

struct ActionResult {
    struct File {
        std::string path;
        BlobName blob;
        bool executable = false;
        Bytes contents;  // may be inlined beside the digest; not verified here
        friend bool operator==(const File&, const File&) = default;
    };
    struct Directory {
        std::string path;
        BlobName tree;                 // a Tree message
        std::optional<BlobName> root;  // a Directory message
        bool sorted = false;
        friend bool operator==(const Directory&, const Directory&) = default;
    };
    struct Symlink {
        std::string path, target;
        friend bool operator==(const Symlink&, const Symlink&) = default;
    };
    std::vector<File> files;
    std::vector<Directory> directories;
    std::vector<Symlink> file_symlinks, directory_symlinks, symlinks;
    int32_t exit_code = 0;
    Bytes stdout_raw, stderr_raw;
    std::optional<BlobName> stdout_digest, stderr_digest;
    Bytes metadata;  // ExecutedActionMetadata, as it came
    friend bool operator==(const ActionResult&, const ActionResult&) = default;
};

constexpr size_t most_outputs = 100'000;  // files, directories and links of one result; files of one tree
constexpr size_t longest_output_path = 4096;

// Strict: a field of a wrong kind, a digest that is no SHA-256 with a size, a missing digest, a repeated single field and
// whatever passes the limits is an Error. Fields that this struct does not know are skipped.
Result<ActionResult> parse_action_result(ByteView message);
// Equal values give equal bytes, which parse_action_result reads back.
Bytes serialise(const ActionResult& result);

// The digests of the files of a Tree message, as strictly.
Result<std::vector<BlobName>> parse_tree_files(ByteView message);

// False for what a client must not write below a folder: an absolute path, an empty one, "." or ".." or "" among its
// segments, a backslash, a NUL.
bool stays_below(std::string_view output_path);

}  // namespace kiln
