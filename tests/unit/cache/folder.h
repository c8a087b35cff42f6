#pragma once
// A folder of its own for each test, removed afterwards.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "cache/disk_store.h"

namespace kiln {

class TestFolder {
public:
    TestFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "kiln-cache-XXXXXX").string();
        path_ = ::mkdtemp(name.data()) == nullptr ? "" : name;
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
        std::filesystem::remove_all(path_, ignored);
    }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

// Without flushing: what these tests end is processes, not the power.
inline DiskOptions unflushed(uint64_t limit = default_cache_limit) {
    DiskOptions options;
    options.sync = Sync::none;
    options.limit = limit;
    return options;
}

inline Bytes bytes_of(std::string_view text) { return {as_bytes(text).begin(), as_bytes(text).end()}; }
inline Digest name_of(std::string_view text) { return sha256(as_bytes(text)); }

// Where the header of disk_store.h says that an entry lies.
inline std::string path_of(const std::string& folder, Keyspace space, const Digest& key) {
    return folder + (space == Keyspace::action ? "/action/" : "/blob/") + key.hex().substr(0, 2) + "/" + key.hex();
}

inline std::string read_file(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_file(const std::string& path, std::string_view text) {
    std::ofstream(path, std::ios::binary | std::ios::trunc).write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace kiln
