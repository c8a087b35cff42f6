#pragma once
// Finds and reads the source files of one stage. An includer's folder comes first, then the manifest's own, then `include:`
// in order. Only paths inside the search roots (the manifest's folder and the `include:` folders) are ever opened; symbolic
// links are not followed up. Every path asked for is remembered, found or not, with the digest of what was read.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/split/lex.h"
#include "compiler/split/split.h"

namespace kiln {

struct SourceFile {
    std::string path;    // as opened
    std::string name;    // relative to the manifest's folder
    std::string folder;  // of `path`
    std::string content;
    LexedFile lexed;
};

// How a name resolved: a file, or why not.
struct Found {
    std::optional<uint16_t> file;
    std::string problem;
};

class Sources {
public:
    Sources(const Manifest& manifest, Files& files, Spellings& spellings);
    // `includer` is absent for the stage's own file and for <name>.
    Found find(std::string_view name, std::optional<uint16_t> includer);
    const SourceFile& file(uint16_t index) const { return *files_[index]; }
    size_t count() const { return files_.size(); }
    const std::vector<SourceRead>& reads() const { return reads_; }
    std::string relative(const std::string& path) const;

    static constexpr size_t max_file = size_t{16} << 20;  // bytes
    static constexpr size_t max_files = 4096;

private:
    bool inside(const std::string& path) const;

    Files& disk_;
    Spellings& spellings_;
    std::string folder_;
    std::vector<std::string> roots_;  // the manifest's folder first
    std::vector<std::unique_ptr<SourceFile>> files_;
    std::map<std::string, Found> known_;  // by path; no file and no problem: absent
    std::vector<SourceRead> reads_;
};

}  // namespace kiln
