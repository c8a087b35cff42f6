#pragma once
// Spellings of preprocessing tokens as small numbers, so that a token is 16 bytes and two spellings compare as integers.
// The operators and the names that the preprocessor knows have fixed numbers.

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace kiln {

namespace spelling {
enum Fixed : uint32_t {
    none,
    // operators, longest first within a letter; the order of `fixed_texts` in spellings.cpp
    paren_open,
    paren_close,
    comma,
    hash,
    paste,
    plus,
    minus,
    tilde,
    bang,
    star,
    slash,
    percent,
    shift_left,
    shift_right,
    less,
    greater,
    less_equal,
    greater_equal,
    equal,
    unequal,
    bit_and,
    bit_xor,
    bit_or,
    logical_and,
    logical_or,
    logical_xor,
    colon,
    // names
    define_,
    undef_,
    if_,
    ifdef_,
    ifndef_,
    elif_,
    else_,
    endif_,
    include_,
    line_,
    pragma_,
    error_,
    version_,
    extension_,
    defined_,
    once_,
    line_macro,
    file_macro,
    version_macro,
    zero,
    one,
    first_free,
};
}  // namespace spelling

class Spellings {
public:
    Spellings();
    Spellings(const Spellings&) = delete;
    Spellings& operator=(const Spellings&) = delete;
    uint32_t intern(std::string_view text);
    uint32_t intern(int64_t number) { return intern(std::string_view(std::to_string(number))); }
    std::string_view text(uint32_t id) const { return texts_[id]; }
    uint32_t size() const { return static_cast<uint32_t>(texts_.size()); }

private:
    void grow();
    std::deque<std::string> owned_;
    std::vector<std::string_view> texts_;
    std::vector<uint64_t> hashes_;
    std::vector<uint32_t> slots_;  // power of two; 0: empty
};

}  // namespace kiln
