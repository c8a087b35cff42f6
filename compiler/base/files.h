#pragma once
// The only seam to the disk. DiskFiles is the real one; MemoryFiles is the fake that records what was read, so that a
// whole pass runs in a unit test. Paths are ordinary strings; the real one takes them relative to the working folder.

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

class Files {
public:
    virtual ~Files() = default;
    // The whole file; nullopt when there is none; an Error when it is there but cannot be read (a folder, no permission,
    // over `read_limit` bytes).
    virtual Result<std::optional<std::string>> read(const std::string& path) = 0;
    // Publishes `bytes` under `path` by a temporary file, a flush to disk and a rename: readers see the old file or the new
    // one. Creates missing folders.
    virtual Status write(const std::string& path, ByteView bytes) = 0;

    static constexpr uint64_t read_limit = uint64_t{4} << 30;
};

class DiskFiles final : public Files {
public:
    Result<std::optional<std::string>> read(const std::string& path) override;
    Status write(const std::string& path, ByteView bytes) override;
};

class MemoryFiles final : public Files {
public:
    MemoryFiles() = default;
    explicit MemoryFiles(std::map<std::string, std::string> initial) : files(std::move(initial)) {}
    Result<std::optional<std::string>> read(const std::string& path) override;
    Status write(const std::string& path, ByteView bytes) override;

    std::map<std::string, std::string> files;
    std::vector<std::string> reads;    // every path asked for, in order, found or not
    std::set<std::string> unwritable;  // paths whose write fails
};

// A path with "." and inner ".." removed, "/" as separator. Leading ".." stay.
std::string normal_path(std::string_view path);
std::string join_path(std::string_view folder, std::string_view relative);  // normalised; `relative` wins when absolute
// `path` as seen from `folder`, so that join_path(folder, result) is `path` again; absolute ones outside stay absolute.
std::string relative_path(std::string_view folder, std::string_view path);
std::string folder_of(std::string_view path);  // "" for a bare name

}  // namespace kiln
