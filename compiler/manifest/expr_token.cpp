#include "compiler/manifest/expr_token.h"

#include <charconv>

namespace kiln {

namespace {

bool name_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

// Longer spellings before their beginnings. Rows with a problem are what people write by habit from other languages.
constexpr struct {
    const char* text;
    TokenKind kind;
    Op op;
    const char* problem;
} spellings[] = {
    {"->", TokenKind::op, Op::implies, nullptr},
    {"||", TokenKind::op, Op::disjunction, nullptr},
    {"&&", TokenKind::op, Op::conjunction, nullptr},
    {"==", TokenKind::op, Op::equal, nullptr},
    {"!=", TokenKind::op, Op::unequal, nullptr},
    {"<=", TokenKind::op, Op::less_equal, nullptr},
    {">=", TokenKind::op, Op::greater_equal, nullptr},
    {"=>", TokenKind::bad, Op::literal, "write '->' for implication or '>=' for a comparison"},
    {"=<", TokenKind::bad, Op::literal, "write '<='"},
    {"<>", TokenKind::bad, Op::literal, "write '!='"},
    {"<", TokenKind::op, Op::less, nullptr},
    {">", TokenKind::op, Op::greater, nullptr},
    {"!", TokenKind::bang, Op::negate, nullptr},
    {"(", TokenKind::open, Op::literal, nullptr},
    {")", TokenKind::close, Op::literal, nullptr},
    {"{", TokenKind::open_brace, Op::literal, nullptr},
    {"}", TokenKind::close_brace, Op::literal, nullptr},
    {",", TokenKind::comma, Op::literal, nullptr},
    {"=", TokenKind::bad, Op::literal, "write '==' to compare"},
    {"&", TokenKind::bad, Op::literal, "write '&&'"},
    {"|", TokenKind::bad, Op::literal, "write '||'"},
};

}  // namespace

ExprToken ExprLexer::next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) ++at_;
    ExprToken token;
    token.offset = static_cast<uint32_t>(at_);
    if (at_ == text_.size()) return token;
    const char c = text_[at_];
    if (name_start(c)) {
        token.kind = TokenKind::name;
        return take(token, name_length());
    }
    if (digit(c) || (c == '-' && at_ + 1 < text_.size() && digit(text_[at_ + 1]))) return integer(token);
    for (const auto& row : spellings) {
        const std::string_view spelling = row.text;
        if (text_.substr(at_, spelling.size()) != spelling) continue;
        token.kind = row.kind;
        token.op = row.op;
        token.problem = row.problem;
        return take(token, spelling.size());
    }
    token.kind = TokenKind::bad;
    token.problem = "this character means nothing in an expression";
    size_t length = 1;  // of the whole character, not of its first byte
    while (at_ + length < text_.size() && (static_cast<unsigned char>(text_[at_ + length]) & 0xC0) == 0x80) ++length;
    return take(token, length);
}

ExprToken ExprLexer::take(ExprToken token, size_t length) {
    token.text = text_.substr(at_, length);
    at_ += length;
    return token;
}

size_t ExprLexer::name_length() const {
    size_t end = at_;
    while (end < text_.size() && (name_start(text_[end]) || digit(text_[end]))) ++end;
    return end - at_;
}

ExprToken ExprLexer::integer(ExprToken token) {
    size_t end = at_ + 1;
    while (end < text_.size() && (name_start(text_[end]) || digit(text_[end]) || text_[end] == '.')) ++end;
    token.kind = TokenKind::integer;
    token = take(token, end - at_);
    if (const ParsedInteger parsed = parse_integer(token.text); parsed.problem != nullptr) {
        token.kind = TokenKind::bad;
        token.problem = parsed.problem;
    } else {
        token.number = parsed.number;
    }
    return token;
}

ParsedInteger parse_integer(std::string_view text) {
    constexpr const char* not_integer = "not an integer (decimal or 0x)";
    constexpr const char* out_of_range = "out of range: -2147483648 to 2147483647";
    const bool negative = !text.empty() && text.front() == '-';
    std::string_view digits = negative ? text.substr(1) : text;
    const bool hex = digits.size() > 2 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
    if (hex) digits.remove_prefix(2);
    if (digits.empty()) return {0, not_integer};
    if (!hex && digits.size() > 1 && digits[0] == '0' && digits.find_first_not_of("0123456789") == std::string_view::npos)
        return {0, "leading zeros mean octal elsewhere: write it without"};
    uint64_t magnitude = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), magnitude, hex ? 16 : 10);
    if (end != digits.data() + digits.size() || code == std::errc::invalid_argument) return {0, not_integer};
    const uint64_t limit = uint64_t{0x7FFFFFFF} + (negative ? 1 : 0);
    if (code == std::errc::result_out_of_range || magnitude > limit) return {0, out_of_range};
    const int64_t value = negative ? -static_cast<int64_t>(magnitude) : static_cast<int64_t>(magnitude);
    return {static_cast<int32_t>(value), nullptr};
}

}  // namespace kiln
