#include "tests/device/uber_text.h"

#include <gtest/gtest.h>

#include "compiler/base/files.h"

namespace kiln::test {

std::string uber_text(const std::string& path, const std::string& defines) {
    const Result<std::optional<std::string>> read = DiskFiles().read(join_path(KILN_SOURCE_DIR "/uber", path));
    EXPECT_TRUE(read.ok() && *read) << "cannot read " << path;
    std::string out;
    if (!read.ok() || !*read) return out;
    const std::string& text = **read;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, end - at);
        at = end + 1;
        const size_t open = line.find('"'), close = line.rfind('"');
        const bool include = line.starts_with("#include") && close > open;
        out += include ? uber_text(join_path(folder_of(path), line.substr(open + 1, close - open - 1))) : line + "\n";
        if (line.starts_with("#version")) out += defines;
    }
    return out;
}

}  // namespace kiln::test
