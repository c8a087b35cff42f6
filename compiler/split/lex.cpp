// The rules are those of glslang 12's scanner, oddities included: it splits a number from a bad suffix, lexes skipped groups
// (so a broken literal is an error there too), and minds a float without a point only outside conditionals.
//
// Line continuations and the three kinds of newline are taken out first into `clean`, with a list of where each physical line
// begins in it; so the scanner proper is one loop over plain bytes and never asks where it is until it makes a token.
#include "compiler/split/lex.h"

#include <algorithm>

#include "compiler/split/lex_number.h"

namespace kiln {

namespace {

constexpr size_t max_token = 1024;  // glslang's MaxTokenLength

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_name_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_name(char c) { return is_name_start(c) || is_digit(c); }

// Where a physical line begins in the cleaned text.
struct LineStart {
    uint32_t offset;
    uint32_t line;
};

struct Cleaned {
    std::string text;
    std::vector<LineStart> starts;
    uint32_t continued_line = 0;
};

Cleaned clean_text(std::string_view in) {
    Cleaned out;
    if (in.substr(0, 3) == "\xEF\xBB\xBF") in.remove_prefix(3);
    out.text.reserve(in.size() + 1);
    uint32_t line = 1;
    out.starts.push_back({0, line});
    const auto newline_at = [&](size_t i) -> size_t {  // length of the newline there, 0 when none
        if (i >= in.size()) return 0;
        if (in[i] == '\n') return 1;
        if (in[i] == '\r') return i + 1 < in.size() && in[i + 1] == '\n' ? 2 : 1;
        return 0;
    };
    for (size_t i = 0; i < in.size();) {
        const char c = in[i];
        if (c == '\\') {
            if (const size_t length = newline_at(i + 1); length != 0) {
                if (out.continued_line == 0) out.continued_line = line;
                i += 1 + length;
                out.starts.push_back({static_cast<uint32_t>(out.text.size()), ++line});
                continue;
            }
        } else if (const size_t length = newline_at(i); length != 0) {
            out.text += '\n';
            i += length;
            out.starts.push_back({static_cast<uint32_t>(out.text.size()), ++line});
            continue;
        }
        out.text += c;
        ++i;
    }
    if (out.text.empty() || out.text.back() != '\n') out.text += '\n';
    return out;
}

class Scanner {
public:
    Scanner(LexedFile& out, std::vector<LineStart> starts, uint16_t file, Spellings& spellings)
        : out_(out), text_(out.clean), starts_(std::move(starts)), file_(file), spellings_(spellings) {}

    void run() {
        out_.tokens.reserve(text_.size() / 4);
        while (at_ < text_.size()) line();
        link_conditionals();
    }
    void run_plain() {
        while (at_ < text_.size())
            if (!token()) ++at_;
    }

private:
    char peek(size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

    void locate(size_t offset, uint32_t& line, uint32_t& column) {
        while (start_ + 1 < starts_.size() && starts_[start_ + 1].offset <= offset) ++start_;
        while (start_ > 0 && starts_[start_].offset > offset) --start_;
        line = starts_[start_].line;
        column = static_cast<uint32_t>(offset - starts_[start_].offset) + 1;
    }

    void problem(size_t offset, std::string message, bool outside_conditionals = false) {
        LexProblem p;
        locate(offset, p.line, p.column);
        p.message = std::move(message);
        p.depth = static_cast<uint32_t>(open_.size());
        p.outside_conditionals = outside_conditionals;
        if (out_.problems.size() < 1000) out_.problems.push_back(std::move(p));
    }

    // Skips white space and comments; true when there was any. Stops at a newline.
    bool skip_space() {
        bool skipped = false;
        for (;;) {
            const char c = peek();
            if (c == ' ' || c == '\t') {
                ++at_;
            } else if (c == '/' && peek(1) == '/') {
                at_ = text_.find('\n', at_);
            } else if (c == '/' && peek(1) == '*') {
                const size_t close = text_.find("*/", at_ + 2);
                if (close == std::string::npos) {
                    problem(at_, "End of input in comment");
                    at_ = text_.size() - 1;
                } else {
                    at_ = close + 2;
                }
            } else {
                return skipped;
            }
            skipped = true;
        }
    }

    void push(Tok kind, size_t begin, size_t end, bool spaced) {
        Token t;
        t.text = spellings_.intern(std::string_view(text_).substr(begin, end - begin));
        locate(begin, t.line, t.column);
        t.file = file_;
        t.kind = kind;
        t.flags = spaced ? Token::spaced : 0;
        out_.tokens.push_back(t);
    }

    // One token on the current line; false at its newline (not consumed).
    bool token() {
        const bool spaced = skip_space();
        const char c = peek();
        if (c == '\n') return false;
        const size_t begin = at_;
        if (is_name_start(c)) {
            while (is_name(peek())) ++at_;
            if (at_ - begin > max_token) problem(begin, "name too long");
            push(Tok::identifier, begin, std::min(at_, begin + max_token), spaced);
        } else if (is_digit(c) || (c == '.' && is_digit(peek(1)))) {
            const NumberLiteral literal = scan_number(text_, begin);
            at_ = literal.end;
            for (const NumberLiteral::Problem& p : literal.problems) problem(begin, p.text, p.outside_conditionals);
            if (at_ - begin > max_token) problem(begin, "numeric literal too long");
            push(literal.kind, begin, std::min(at_, begin + max_token), spaced);
        } else if (c == '"') {
            string();
            push(Tok::string, begin, at_, spaced);
        } else if (c == '#') {
            ++at_;
            push(Tok::hash, begin, at_, spaced);
        } else if (c == '\0' || static_cast<unsigned char>(c) >= 0x80) {
            static constexpr char digits[] = "0123456789abcdef";
            const auto byte = static_cast<unsigned char>(c);
            problem(begin, std::string("byte 0x") + digits[byte >> 4] + digits[byte & 15] +
                               " outside a comment: GLSL is written in ASCII");
            while (peek() != '\n' && (peek() == '\0' || static_cast<unsigned char>(peek()) >= 0x80)) ++at_;
        } else {
            at_ += operator_length();
            push(Tok::op, begin, at_, spaced);
        }
        return true;
    }

    size_t operator_length() const {
        const char c = peek(), d = peek(1);
        switch (c) {
            case '<':
            case '>':
                if (d == c) return peek(2) == '=' ? 3 : 2;
                return d == '=' ? 2 : 1;
            case '+':
            case '-':
            case '&':
            case '|':
            case '^':
                return d == c || d == '=' ? 2 : 1;
            case '*':
            case '/':
            case '%':
            case '=':
            case '!':
                return d == '=' ? 2 : 1;
            case ':':
                return d == ':' ? 2 : 1;
            default:
                return 1;
        }
    }

    void string() {
        const size_t begin = at_++;
        while (peek() != '"' && peek() != '\n') at_ += peek() == '\\' && peek(1) != '\n' ? 2 : 1;
        if (peek() == '"')
            ++at_;
        else
            problem(begin, "End of line in string");
        if (at_ - begin > max_token) problem(begin, "string too long");
    }

    void line() {
        const bool spaced = skip_space();
        if (peek() == '\n') {
            ++at_;
            return;
        }
        if (peek() != '#') {
            text_line(spaced);
            return;
        }
        Item item;
        locate(at_, item.line, item.column);
        item.depth = static_cast<uint32_t>(open_.size());
        ++at_;
        skip_space();
        const size_t name_at = at_;
        if (is_name_start(peek())) {
            while (is_name(peek())) ++at_;
            item.name = spellings_.intern(std::string_view(text_).substr(name_at, at_ - name_at));
            item.kind = directive_named(item.name);
        } else {
            item.kind = peek() == '\n' ? Directive::empty : Directive::unknown;
        }
        item.begin = static_cast<uint32_t>(out_.tokens.size());
        const size_t raw = at_;
        if (item.kind == Directive::include) header_name();
        while (token()) {
        }
        item.end = static_cast<uint32_t>(out_.tokens.size());
        item.raw_begin = static_cast<uint32_t>(raw);
        item.raw_end = static_cast<uint32_t>(at_);
        while (item.raw_begin < item.raw_end && (text_[item.raw_begin] == ' ' || text_[item.raw_begin] == '\t')) ++item.raw_begin;
        while (item.raw_end > item.raw_begin && (text_[item.raw_end - 1] == ' ' || text_[item.raw_end - 1] == '\t'))
            --item.raw_end;
        ++at_;
        conditional(item);
        out_.items.push_back(item);
    }

    void text_line(bool spaced) {
        const auto begin = static_cast<uint32_t>(out_.tokens.size());
        const size_t at = at_;
        while (token()) {
        }
        ++at_;
        if (out_.tokens.size() == begin) return;
        if (spaced) out_.tokens[begin].flags |= Token::spaced;
        if (!out_.items.empty() && out_.items.back().kind == Directive::text && out_.items.back().end == begin) {
            out_.items.back().end = static_cast<uint32_t>(out_.tokens.size());
            return;
        }
        Item item;
        item.begin = begin;
        item.end = static_cast<uint32_t>(out_.tokens.size());
        item.depth = static_cast<uint32_t>(open_.size());
        locate(at, item.line, item.column);
        out_.items.push_back(item);
    }

    // #include names its header in its own way: <name> or "name", without escapes.
    void header_name() {
        while (peek() == ' ' || peek() == '\t') ++at_;
        const char close = peek() == '<' ? '>' : peek() == '"' ? '"' : '\0';
        if (close == '\0') return;
        const size_t begin = at_++;
        while (peek() != close && peek() != '\n') ++at_;
        if (peek() == '\n') {
            at_ = begin;
            return;
        }
        ++at_;
        push(Tok::string, begin, at_, true);
    }

    static Directive directive_named(uint32_t name) {
        switch (name) {
            case spelling::define_:
                return Directive::define;
            case spelling::undef_:
                return Directive::undef;
            case spelling::if_:
                return Directive::if_;
            case spelling::ifdef_:
                return Directive::ifdef;
            case spelling::ifndef_:
                return Directive::ifndef;
            case spelling::elif_:
                return Directive::elif;
            case spelling::else_:
                return Directive::else_;
            case spelling::endif_:
                return Directive::endif;
            case spelling::include_:
                return Directive::include;
            case spelling::line_:
                return Directive::line;
            case spelling::pragma_:
                return Directive::pragma;
            case spelling::error_:
                return Directive::error;
            case spelling::version_:
                return Directive::version;
            case spelling::extension_:
                return Directive::extension;
            default:
                return Directive::unknown;
        }
    }

    struct Open {
        uint32_t item;  // the last sibling seen
        bool else_seen;
    };

    void conditional(Item& item) {
        const auto index = static_cast<uint32_t>(out_.items.size());
        switch (item.kind) {
            case Directive::if_:
            case Directive::ifdef:
            case Directive::ifndef:
                open_.push_back({index, false});
                out_.max_depth = std::max(out_.max_depth, static_cast<uint32_t>(open_.size()));
                break;
            case Directive::elif:
            case Directive::else_:
            case Directive::endif: {
                const char* const name = item.kind == Directive::elif    ? "#elif"
                                         : item.kind == Directive::else_ ? "#else"
                                                                         : "#endif";
                if (open_.empty()) {
                    at_item(item, std::string(name) + " without #if in this file");
                    item.kind = Directive::empty;
                    return;
                }
                Open& open = open_.back();
                item.depth = static_cast<uint32_t>(open_.size()) - 1;
                if (item.kind != Directive::elif && item.begin != item.end)
                    at_item(item, std::string("unexpected tokens following ") + name);
                if (item.kind != Directive::endif && open.else_seen) {
                    at_item(item, std::string(name) + " after #else");
                    item.kind = Directive::empty;
                    return;
                }
                out_.items[open.item].next = index;
                open.item = index;
                if (item.kind == Directive::else_) open.else_seen = true;
                if (item.kind == Directive::endif) open_.pop_back();
                break;
            }
            default:
                break;
        }
    }

    void at_item(const Item& item, std::string message) {
        LexProblem p;
        p.line = item.line;
        p.column = item.column;
        p.message = std::move(message);
        if (out_.problems.size() < 1000) out_.problems.push_back(std::move(p));
    }

    // Unclosed conditionals end with the file: each gets an #endif of its own.
    void link_conditionals() {
        while (!open_.empty()) {
            const Open open = open_.back();
            open_.pop_back();
            at_item(out_.items[open.item], "missing #endif");
            Item item;
            item.kind = Directive::endif;
            item.line = starts_.back().line;
            item.column = 1;
            item.begin = item.end = static_cast<uint32_t>(out_.tokens.size());
            item.depth = static_cast<uint32_t>(open_.size());
            out_.items[open.item].next = static_cast<uint32_t>(out_.items.size());
            out_.items.push_back(item);
        }
    }

    LexedFile& out_;
    const std::string& text_;
    std::vector<LineStart> starts_;
    size_t start_ = 0;
    size_t at_ = 0;
    uint16_t file_;
    Spellings& spellings_;
    std::vector<Open> open_;
};

}  // namespace

LexedFile lex_file(std::string_view content, uint16_t file, Spellings& spellings) {
    LexedFile out;
    Cleaned cleaned = clean_text(content);
    out.clean = std::move(cleaned.text);
    out.continued = cleaned.continued_line != 0;
    out.continued_line = cleaned.continued_line;
    Scanner(out, std::move(cleaned.starts), file, spellings).run();
    return out;
}

std::vector<Token> lex_text(std::string_view content, uint16_t file, Spellings& spellings) {
    LexedFile out;
    Cleaned cleaned = clean_text(content);
    out.clean = std::move(cleaned.text);
    Scanner(out, std::move(cleaned.starts), file, spellings).run_plain();
    return std::move(out.tokens);
}

}  // namespace kiln
