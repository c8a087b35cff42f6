#pragma once
// The command line as data: verbs are rows of a table, options are rows of a verb. Help and errors come from the same rows.

#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/result.h"

namespace kiln {

struct Option {
    const char* name;    // "--scene"
    const char* letter;  // "-s", or nullptr
    const char* value;   // "FILE", or nullptr for a flag
    const char* help;
    bool repeats = false;
};

class Args;

struct Verb {
    const char* name;
    const char* usage;           // "MANIFEST [--scene S]…"
    const char* summary;         // one line
    size_t least = 0, most = 0;  // number of plain words; most = npos: any
    std::vector<Option> options;
    const char* example;
    int (*run)(const Args& args);
    bool hidden = false;
};

class Args {
public:
    // Splits the words after the verb. "--name=value", "--name value", "-n value", "-nvalue"; "--" ends options.
    static Result<Args> parse(const Verb& verb, const std::vector<std::string>& words);

    const std::vector<std::string>& words() const { return words_; }
    bool has(std::string_view name) const;
    std::string value(std::string_view name, std::string fallback = {}) const;
    std::vector<std::string> values(std::string_view name) const;
    // A whole number in [least, most], the fallback when absent.
    Result<uint64_t> number(std::string_view name, uint64_t fallback, uint64_t least, uint64_t most) const;

private:
    std::vector<std::string> words_;
    std::vector<std::pair<std::string, std::string>> options_;
};

std::string help_of(const Verb& verb);
std::string help_of(const std::vector<Verb>& verbs);

}  // namespace kiln
