// A caret inside an expression needs the way back from a byte of a scalar's value to a byte of the file, which no YAML
// library keeps. The scalar is decoded once more here, noting the origin of every byte, and the result must equal
// the library's: if it ever does not, the answer is "not known" instead of a wrong place.
#include <algorithm>
#include <string>

#include "compiler/manifest/yaml.h"

namespace kiln {

namespace {

class Decoder {
public:
    Decoder(std::string_view text, size_t offset, size_t wanted) : text_(text), at_(offset), wanted_(wanted) {}

    void plain() { flow(0); }
    void quoted(char quote) {
        ++at_;
        flow(quote);
    }
    // Reads a block's header and goes to its first line. The indentation that the header states relative to the parent's; 0:
    // none.
    size_t block_header();
    // Of the first line that is not blank.
    size_t block_indent() const;
    void block(size_t indent);

    std::string value;
    std::vector<uint32_t> origin;

private:
    bool done() const { return at_ >= text_.size() || value.size() > wanted_; }
    char look(size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
    static bool blank(char c) { return c == ' ' || c == '\t'; }
    bool at_break() const { return look() == '\n' || (look() == '\r' && look(1) == '\n'); }
    void skip_break() { at_ += look() == '\r' ? 2 : 1; }
    void put(char c, size_t from) {
        value += c;
        origin.push_back(static_cast<uint32_t>(from));
    }
    void flow(char quote);
    void escape();
    void fold_lines();

    std::string_view text_;
    size_t at_;
    size_t wanted_;  // nothing past the known length needs decoding
    bool folded_ = false;
};

void append_utf8(std::string& out, uint32_t c) {
    const auto byte = [&](uint32_t b) { out += static_cast<char>(b); };
    if (c < 0x80) {
        byte(c);
    } else if (c < 0x800) {
        byte(0xC0 | c >> 6), byte(0x80 | (c & 0x3F));
    } else if (c < 0x10000) {
        byte(0xE0 | c >> 12), byte(0x80 | (c >> 6 & 0x3F)), byte(0x80 | (c & 0x3F));
    } else {
        byte(0xF0 | (c >> 18 & 7)), byte(0x80 | (c >> 12 & 0x3F)), byte(0x80 | (c >> 6 & 0x3F)), byte(0x80 | (c & 0x3F));
    }
}

// At a line break inside a plain or quoted scalar: one break is a space, n+1 breaks are n line ends, indentation goes.
void Decoder::fold_lines() {
    const size_t from = at_;
    size_t breaks = 0;
    while (!done()) {
        if (at_break())
            ++breaks, skip_break();
        else if (blank(look()))
            ++at_;
        else
            break;
    }
    if (breaks == 1) put(' ', from);
    for (size_t i = 1; i < breaks; ++i) put('\n', from);
}

void Decoder::escape() {
    const size_t from = at_++;
    if (at_break()) {  // an escaped line end joins the lines
        size_t breaks = 0;
        while (!done() && (at_break() || blank(look()))) {
            if (at_break())
                ++breaks, skip_break();
            else
                ++at_;
        }
        for (size_t i = 1; i < breaks; ++i) put('\n', from);
        return;
    }
    const char c = look();
    ++at_;
    static constexpr std::pair<char, uint32_t> table[] = {{'0', 0},    {'a', 7},    {'b', 8},      {'t', 9},     {'\t', 9},
                                                          {'n', 10},   {'v', 11},   {'f', 12},     {'r', 13},    {'e', 27},
                                                          {' ', ' '},  {'"', '"'},  {'\'', '\''},  {'/', '/'},   {'\\', '\\'},
                                                          {'N', 0x85}, {'_', 0xA0}, {'L', 0x2028}, {'P', 0x2029}};
    uint32_t code = 0;
    const size_t digits = c == 'x' ? 2 : c == 'u' ? 4 : c == 'U' ? 8 : 0;
    for (const auto& [letter, meaning] : table)
        if (digits == 0 && letter == c) code = meaning;
    for (size_t i = 0; i < digits; ++i, ++at_) {
        const char d = look();
        code = code << 4 | static_cast<uint32_t>(d >= '0' && d <= '9' ? d - '0' : (d | 0x20) - 'a' + 10);
    }
    append_utf8(value, code);
    origin.resize(value.size(), static_cast<uint32_t>(from));
}

// Plain and quoted scalars: blanks before a line break do not count.
void Decoder::flow(char quote) {
    while (!done()) {
        const char c = look();
        if (quote != 0 && c == quote) {
            if (quote == '\'' && look(1) == '\'') {
                put('\'', at_);
                at_ += 2;
                continue;
            }
            break;
        }
        if (quote == '"' && c == '\\') {
            escape();
            continue;
        }
        size_t ahead = 0;
        while (blank(look(ahead))) ++ahead;
        const bool line_ends = look(ahead) == '\n' || (look(ahead) == '\r' && look(ahead + 1) == '\n');
        if (line_ends) {
            at_ += ahead;
            fold_lines();
        } else {
            put(c, at_);
            ++at_;
        }
    }
}

size_t Decoder::block_header() {
    folded_ = look() == '>';
    ++at_;
    size_t stated = 0;
    for (; !done() && !at_break() && look() != '#'; ++at_)
        if (look() >= '1' && look() <= '9') stated = static_cast<size_t>(look() - '0');
    while (!done() && !at_break()) ++at_;
    if (!done()) skip_break();
    return stated;
}

size_t Decoder::block_indent() const {
    for (size_t probe = at_;;) {
        size_t column = 0;
        while (probe < text_.size() && text_[probe] == ' ') ++probe, ++column;
        if (probe >= text_.size() || (text_[probe] != '\n' && text_[probe] != '\r')) return column;
        probe += text_[probe] == '\r' ? 2 : 1;
    }
}

// Literal and folded block scalars.
void Decoder::block(size_t indent) {
    bool previous_more_indented = true;
    bool first = true;
    while (value.size() <= wanted_) {
        const size_t breaks_from = at_;
        size_t empty_lines = 0;
        size_t column = 0;
        for (;;) {  // blank lines, then the indentation of the next line with text
            column = 0;
            while (column < indent && look() == ' ') ++at_, ++column;
            if (!at_break()) break;
            ++empty_lines;
            skip_break();
        }
        const bool ended = at_ >= text_.size() || column < indent;
        const bool more_indented = !ended && blank(look());
        if (!first) {
            // The break that ended the previous line, and the blank lines after it.
            const bool join = folded_ && !ended && !previous_more_indented && !more_indented;
            const size_t break_at = breaks_from - (breaks_from >= 2 && text_[breaks_from - 2] == '\r' ? 2 : 1);
            if (!join)
                put('\n', break_at);
            else if (empty_lines == 0)
                put(' ', break_at);
        }
        for (size_t i = 0; i < empty_lines; ++i) put('\n', breaks_from);
        if (ended) return;
        while (!done() && !at_break()) {
            put(look(), at_);
            ++at_;
        }
        if (done()) return;
        skip_break();
        previous_more_indented = more_indented;
        first = false;
    }
}

// The origins, when what was decoded begins with the value; what follows it (a plain scalar's neighbours, stripped line ends) is
// not part of it.
std::vector<uint32_t> origins(Decoder& decoder, size_t offset, std::string_view value) {
    if (std::string_view(decoder.value).substr(0, value.size()) != value) return {};
    std::vector<uint32_t> origin = std::move(decoder.origin);
    origin.resize(value.size());
    origin.push_back(origin.empty() ? static_cast<uint32_t>(offset) : origin.back() + 1);
    return origin;
}

// A stated indentation is relative to the parent's, which the scalar itself does not show: the one is right that gives the value.
std::vector<uint32_t> block_origins(std::string_view text, size_t offset, std::string_view value) {
    constexpr size_t most_tries = 100;
    Decoder header(text, offset, value.size());
    const size_t stated = header.block_header(), seen = header.block_indent();
    const size_t first = stated == 0 ? seen : stated;
    for (size_t indent = first; indent <= seen && indent < first + most_tries; ++indent) {
        Decoder body = header;
        body.block(indent);
        if (std::vector<uint32_t> found = origins(body, offset, value); !found.empty()) return found;
    }
    return {};
}

}  // namespace

std::vector<uint32_t> scalar_offsets(std::string_view text, size_t offset, YamlStyle style, std::string_view value) {
    if (style == YamlStyle::block) return block_origins(text, offset, value);
    Decoder decoder(text, offset, value.size());
    if (style == YamlStyle::plain)
        decoder.plain();
    else
        decoder.quoted(style == YamlStyle::single_quoted ? '\'' : '"');
    return origins(decoder, offset, value);
}

}  // namespace kiln
