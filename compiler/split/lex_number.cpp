#include "compiler/split/lex_number.h"

#include <cstdint>
#include <limits>
#include <utility>

namespace kiln {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_hex(char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

class Scanner {
public:
    Scanner(std::string_view text, size_t begin) : text_(text), at_(begin) {}

    NumberLiteral run() {
        out_.kind = number();
        out_.end = at_;
        return std::move(out_);
    }

private:
    char peek(size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
    void problem(const char* text, bool outside_conditionals = false) { out_.problems.push_back({text, outside_conditionals}); }

    bool take(char a, char b) {
        if (peek() != a && peek() != b) return false;
        ++at_;
        return true;
    }

    // [u][l][s], [l] or [s]; tells whether the literal stays a plain integer and how many bits it may have.
    Tok integer_suffix(unsigned& bits) {
        const size_t begin = at_;
        bits = 32;
        if (take('u', 'U')) {
            if (take('l', 'L')) bits = 64;
            if (take('s', 'S') && bits == 32) bits = 16;
        } else if (take('l', 'L')) {
            bits = 64;
        } else if (take('s', 'S')) {
            bits = 16;
        }
        return at_ == begin ? Tok::integer : Tok::number;
    }

    Tok number() {
        const size_t begin = at_;
        unsigned bits = 32;
        if (peek() == '0' && (peek(1) == 'x' || peek(1) == 'X')) {
            at_ += 2;
            const size_t digits = at_;
            uint64_t value = 0;
            bool big = false;
            for (; is_hex(peek()); ++at_) {
                const char c = peek();
                big = big || value > 0x0fffffffffffffffu;
                value = value << 4 | static_cast<uint64_t>(is_digit(c) ? c - '0' : (c | 0x20) - 'a' + 10);
            }
            if (at_ == digits) problem("bad digit in hexadecimal literal");
            const Tok kind = integer_suffix(bits);
            if (big || (bits == 32 && value > 0xffffffffu)) problem("hexadecimal literal too big");
            return kind;
        }
        while (is_digit(peek())) ++at_;
        const size_t digits_end = at_;
        switch (peek()) {
            case '.':
            case 'e':
            case 'E':
            case 'f':
            case 'F':
            case 'h':
            case 'H':
                return floating();
            default:
                break;
        }
        const Tok kind = integer_suffix(bits);
        uint64_t value = 0;
        bool big = false;
        if (text_[begin] == '0') {
            bool octal = true;
            for (size_t i = begin; i < digits_end; ++i) {
                octal = octal && text_[i] < '8';
                if (!octal) break;
                big = big || value > 0x1fffffffffffffffu;
                value = value << 3 | static_cast<uint64_t>(text_[i] - '0');
            }
            if (!octal) problem("octal literal digit too large");
            if (big || (bits != 64 && value > 0xffffffffu)) problem("octal literal too big");
        } else {
            const uint64_t limit = bits == 64 ? std::numeric_limits<uint64_t>::max() : bits == 16 ? 0xffffu : 0xffffffffu;
            for (size_t i = begin; i < digits_end && !big; ++i) {
                const auto digit = static_cast<uint64_t>(text_[i] - '0');
                big = value > limit / 10 || (value == limit / 10 && digit > limit % 10);
                value = value * 10 + digit;
            }
            if (big) problem("numeric literal too big");
        }
        return kind;
    }

    Tok floating() {
        bool point_or_exponent = false;
        if (peek() == '.') {
            point_or_exponent = true;
            ++at_;
            while (is_digit(peek())) ++at_;
        }
        if (take('e', 'E')) {
            point_or_exponent = true;
            take('+', '-');
            if (!is_digit(peek())) problem("bad character in float exponent");
            while (is_digit(peek())) ++at_;
        }
        const char c = peek();
        const bool is_long = c == 'l' || c == 'L', half = c == 'h' || c == 'H', single = c == 'f' || c == 'F';
        if ((is_long || half || single) && !point_or_exponent) problem("float literal needs a decimal point or exponent", true);
        if (single)
            ++at_;
        else if ((is_long || half) && (peek(1) == 'f' || peek(1) == 'F'))
            at_ += 2;
        return Tok::number;
    }

    const std::string_view text_;
    size_t at_;
    NumberLiteral out_;
};

}  // namespace

NumberLiteral scan_number(std::string_view text, size_t begin) { return Scanner(text, begin).run(); }

}  // namespace kiln
