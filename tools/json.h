#pragma once
// One JSON document, written front to back. Strings that are not UTF-8 have their bad bytes replaced by U+FFFD.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kiln {

class Json {
public:
    Json& object() { return open('{'); }
    Json& array() { return open('['); }
    Json& end();  // closes the innermost object or array
    Json& key(std::string_view name);
    Json& text(std::string_view value);
    Json& number(double value);
    Json& number(uint64_t value);
    Json& boolean(bool value);
    // key + value
    Json& text(std::string_view name, std::string_view value) { return key(name).text(value); }
    Json& number(std::string_view name, uint64_t value) { return key(name).number(value); }
    Json& number(std::string_view name, double value) { return key(name).number(value); }
    std::string take();  // ends with a newline

private:
    Json& open(char bracket);
    void separate();
    std::string out_;
    std::vector<char> closing_;
    bool first_ = true;
    bool after_key_ = false;
};

}  // namespace kiln
