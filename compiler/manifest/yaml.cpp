// yaml-cpp's event interface, because its Node interface hides anchors, duplicate keys and further documents. Four of the
// library's habits need guarding against:
//   - it takes the byte 4 for the end of input, and text with zero bytes for UTF-16: such text is refused before it starts;
//   - it queues every token of a bracketed collection before it reports the first, since the whole might be a key. The
//     stream that feeds it counts brackets and commas since the last event and ends the input early when there are too many;
//   - it takes the end of the file for the end of a quoted text;
//   - it drops the tag of an empty value: tags and anchors are recognised by the character at the reported place.
#include "compiler/manifest/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <cstring>
#include <istream>
#include <streambuf>
#include <unordered_map>

namespace kiln {

namespace {

// Feeds a text piecemeal and stops early when the reader falls too far behind with what it has seen.
class Feed final : public std::streambuf {
public:
    explicit Feed(std::string_view text) : rest_(text) {}
    void event() { items_ = 0, open_ = 0; }
    bool stopped() const { return too_deep_ || too_long_; }
    bool too_deep() const { return too_deep_; }
    void stop() { too_long_ = true; }

protected:
    std::streamsize xsgetn(char* to, std::streamsize wanted) override {
        if (stopped()) return 0;
        const size_t n = std::min(rest_.size(), static_cast<size_t>(wanted));
        for (const char c : rest_.substr(0, n)) {
            if (c == ',' || c == '[' || c == '{' || c == ':') ++items_;
            if (c == '[' || c == '{') ++open_;
            if ((c == ']' || c == '}') && open_ > 0) --open_;
        }
        too_deep_ = open_ > open_limit;
        too_long_ = items_ > Yaml::flow_limit;
        std::memcpy(to, rest_.data(), n);
        rest_.remove_prefix(n);
        return static_cast<std::streamsize>(n);
    }

private:
    static constexpr size_t open_limit = 4096;
    std::string_view rest_;
    size_t items_ = 0, open_ = 0;
    bool too_deep_ = false, too_long_ = false;
};

constexpr const char* quote_hint = "quote it: text that begins with '!', '&', '*', '{' or '[' means something else to YAML";
constexpr const char* quote_expression =
    "quote the expression: text that begins with '!', '&', '*', '{' or '[' means something else to YAML";

bool is_rule(std::string_view line) {
    return line.find("forbid:") != std::string_view::npos || line.find("require:") != std::string_view::npos;
}

// The library's messages in terms of what to change.
std::string plain_words(const std::string& message) {
    static const std::pair<const char*, const char*> table[] = {
        {YAML::ErrorMsg::END_OF_MAP, "expected a key here: check the indentation, or quote text that goes on over lines"},
        {YAML::ErrorMsg::END_OF_MAP_FLOW, "expected ',' or '}' here; text that holds braces, brackets or commas needs quotes"},
        {YAML::ErrorMsg::END_OF_SEQ, "expected '- ' here: check the indentation"},
        {YAML::ErrorMsg::END_OF_SEQ_FLOW, "expected ',' or ']' here; text that holds braces, brackets or commas needs quotes"},
        {YAML::ErrorMsg::FLOW_END, "this bracket closes nothing; text that holds braces or brackets needs quotes"},
        {YAML::ErrorMsg::MAP_VALUE, "a ':' cannot stand here; text that holds ': ' needs quotes"},
        {YAML::ErrorMsg::MAP_KEY, "a key cannot stand here: check the indentation"},
        {YAML::ErrorMsg::BLOCK_ENTRY, "'- ' cannot stand here: check the indentation"},
        {YAML::ErrorMsg::UNKNOWN_TOKEN, "text cannot begin with this character: it needs quotes"},
        {YAML::ErrorMsg::EOF_IN_SCALAR, "the file ends inside this text"},
    };
    for (const auto& [theirs, ours] : table)
        if (message == theirs) return ours;
    std::string out = message;
    for (char& c : out)
        if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return out;
}

// Of the first line with content: where a directive ('%YAML', '%TAG') begins, or npos.
size_t find_directive(std::string_view text) {
    for (size_t at = 0; at < text.size();) {
        const size_t first = text.find_first_not_of(" \t\r\n", at);
        if (first == std::string_view::npos) break;
        if (text[first] == '%') return first;
        if (text[first] != '#') break;
        at = std::min(text.find('\n', first), text.size());
    }
    return std::string_view::npos;
}

// Past the quoted scalar that begins at `offset`, or npos when it does not end.
size_t end_of_quoted(std::string_view text, size_t offset) {
    const char quote = text[offset];
    for (size_t at = offset + 1; at < text.size(); ++at) {
        if (quote == '"' && text[at] == '\\')
            ++at;
        else if (quote == '\'' && text[at] == quote && at + 1 < text.size() && text[at + 1] == quote)
            ++at;
        else if (text[at] == quote)
            return at + 1;
    }
    return std::string_view::npos;
}

// The offset of the first byte that may not be in a manifest, and why.
struct Unfit {
    size_t offset = 0;
    const char* why = nullptr;
};

Unfit find_unfit(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    for (size_t i = 0; i < text.size();) {
        const unsigned c = byte(i);
        if (c < 0x80) {
            if (c == '\r' && byte(i + 1) != '\n') return {i, "a carriage return without a line feed"};
            if ((c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F) return {i, "a control character"};
            ++i;
            continue;
        }
        const size_t length = c >= 0xC2 && c <= 0xDF ? 2 : c >= 0xE0 && c <= 0xEF ? 3 : c >= 0xF0 && c <= 0xF4 ? 4 : 0;
        bool good = length != 0;
        for (size_t k = 1; k < length; ++k) good = good && (byte(i + k) & 0xC0) == 0x80;
        if (c == 0xE0) good = good && byte(i + 1) >= 0xA0;
        if (c == 0xED) good = good && byte(i + 1) < 0xA0;  // surrogates
        if (c == 0xF0) good = good && byte(i + 1) >= 0x90;
        if (c == 0xF4) good = good && byte(i + 1) < 0x90;
        if (!good) return {i, "not UTF-8"};
        i += length;
    }
    return {};
}

}  // namespace

class YamlBuilder final : public YAML::EventHandler {
public:
    YamlBuilder(Yaml& yaml, Feed& feed, Diags& diags) : yaml_(yaml), feed_(feed), errors_(yaml, diags) {}

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (++documents_ != 2) return;
        const size_t offset = offset_of(mark);
        const bool marked = yaml_.text_.compare(offset, 3, "---") == 0;
        reject(offset, marked ? "a second document: a file holds one"
                              : "this does not belong to what is above it: check the indentation; a file holds one document");
    }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(mark, YamlKind::null, nullptr); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { add(mark, YamlKind::null, nullptr); }
    void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& value) override {
        add(mark, YamlKind::scalar, &value);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
        open(mark, YamlKind::sequence);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
        open(mark, YamlKind::map);
    }
    void OnMapEnd() override { close(); }

    void failed(size_t offset, const std::string& message);
    void reject(size_t offset, std::string message, std::vector<std::string> notes = {}) {
        errors_.at(yaml_.place_at(offset), std::move(message), std::move(notes));
    }
    bool any_errors() const { return errors_.any(); }
    int documents() const { return documents_; }

private:
    struct Open {
        Yaml::Node node = 0;
        Yaml::Node last = 0;  // child; 0: none yet
        uint32_t children = 0;
    };

    size_t offset_of(const YAML::Mark& mark) const {
        return mark.pos < 0 ? yaml_.text_.size() : std::min(static_cast<size_t>(mark.pos), yaml_.text_.size());
    }
    char at(size_t offset) const { return offset < yaml_.text_.size() ? yaml_.text_[offset] : '\0'; }
    bool skipping() const { return documents_ > 1 || depth_ > Yaml::depth_limit || feed_.stopped(); }
    Yaml::Node add(const YAML::Mark& mark, YamlKind kind, const std::string* value);
    void open(const YAML::Mark& mark, YamlKind kind);
    void close();
    bool property(size_t offset);
    bool spelt_null(size_t offset) const;
    void check_keys(Yaml::Node map);

    Yaml& yaml_;
    Feed& feed_;
    YamlErrors errors_;
    std::vector<Open> stack_;
    size_t depth_ = 0;
    size_t last_offset_ = 0;  // of the last event
    int documents_ = 0;
};

// Refuses a tag, an anchor or an alias that stands where a node should.
bool YamlBuilder::property(size_t offset) {
    const char c = at(offset);
    if (c != '!' && c != '&' && c != '*') return false;
    const std::string line = yaml_.source_line(yaml_.place_at(offset));
    reject(offset,
           c == '!'   ? "'!' begins a YAML tag, which kiln does not use"
           : c == '&' ? "'&' begins a YAML anchor, which kiln does not use"
                      : "'*' begins a YAML alias, which kiln does not use",
           {is_rule(line) ? quote_expression : quote_hint});
    return true;
}

bool YamlBuilder::spelt_null(size_t offset) const {
    for (const char* const word : {"~", "null", "Null", "NULL"}) {
        const size_t length = std::strlen(word);
        if (yaml_.text_.compare(offset, length, word) == 0 && std::strchr(" \t\r\n,]}#:", at(offset + length)) != nullptr)
            return true;
    }
    return false;
}

Yaml::Node YamlBuilder::add(const YAML::Mark& mark, YamlKind kind, const std::string* value) {
    feed_.event();
    if (skipping()) return 0;
    size_t offset = offset_of(mark);
    last_offset_ = offset;
    property(offset);
    Yaml::Entry entry;
    entry.kind = kind;
    const char c = at(offset);
    if (kind == YamlKind::null && !stack_.empty() && !spelt_null(offset)) {
        // An absent value is reported where the next token begins: go back behind what asked for it.
        while (offset > 0 && std::strchr(" \t\r\n", yaml_.text_[offset - 1]) != nullptr) --offset;
    }
    entry.offset = static_cast<uint32_t>(offset);
    if (value != nullptr) {
        entry.style = c == '\''              ? YamlStyle::single_quoted
                      : c == '"'             ? YamlStyle::double_quoted
                      : c == '|' || c == '>' ? YamlStyle::block
                                             : YamlStyle::plain;
        entry.size = static_cast<uint32_t>(value->size());
        const bool quoted = entry.style == YamlStyle::single_quoted || entry.style == YamlStyle::double_quoted;
        const size_t begin = offset + (quoted ? 1 : 0);
        if (quoted && end_of_quoted(yaml_.text_, offset) == std::string_view::npos) reject(offset, "this quote is not closed");
        if (entry.style != YamlStyle::block && yaml_.text_.compare(begin, value->size(), *value) == 0) {
            entry.begin = static_cast<uint32_t>(begin);
        } else {
            entry.decoded = true;
            entry.begin = static_cast<uint32_t>(yaml_.decoded_.size());
            yaml_.decoded_ += *value;
        }
    }
    const Yaml::Node node = static_cast<Yaml::Node>(yaml_.nodes_.size());
    if (node == Yaml::node_limit) {
        reject(offset, "more than " + std::to_string(Yaml::node_limit) + " keys, values and collections");
        feed_.stop();
        return 0;
    }
    yaml_.nodes_.push_back(entry);
    if (!stack_.empty()) {
        Open& parent = stack_.back();
        const bool is_key = yaml_.kind(parent.node) == YamlKind::map && parent.children % 2 == 0;
        if (is_key && kind != YamlKind::scalar && !errors_.any()) reject(offset, "a key must be a name");
        (parent.last == 0 ? yaml_.nodes_[parent.node].begin : yaml_.nodes_[parent.last].next) = node;
        parent.last = node;
        ++parent.children;
    }
    return node;
}

void YamlBuilder::open(const YAML::Mark& mark, YamlKind kind) {
    if (++depth_ == Yaml::depth_limit + 1 && documents_ < 2)
        reject(offset_of(mark), "nested deeper than " + std::to_string(Yaml::depth_limit) + " levels");
    if (skipping()) {
        feed_.event();
        return;
    }
    stack_.push_back({add(mark, kind, nullptr), 0, 0});
}

void YamlBuilder::close() {
    const bool skipped = skipping();
    --depth_;
    if (skipped || stack_.empty()) return;
    const Open done = stack_.back();
    stack_.pop_back();
    const bool map = yaml_.kind(done.node) == YamlKind::map;
    yaml_.nodes_[done.node].size = map ? done.children / 2 : done.children;
    if (map) check_keys(done.node);
}

void YamlBuilder::check_keys(Yaml::Node map) {
    std::unordered_map<std::string_view, Yaml::Node> seen;
    seen.reserve(yaml_.size(map));
    for (const Yaml::Pair& pair : yaml_.pairs(map)) {
        if (yaml_.kind(pair.key) != YamlKind::scalar) continue;
        const std::string_view key = yaml_.value(pair.key);
        const size_t offset = yaml_.nodes_[pair.key].offset;
        if (key == "<<" && yaml_.is_plain(pair.key)) reject(offset, "'<<' is YAML's merge key, which kiln does not use");
        const auto [first, fresh] = seen.emplace(key, pair.key);
        if (!fresh)
            reject(offset, "duplicate key '" + std::string(key.substr(0, 64)) + "'",
                   {"first at " + to_string(yaml_.place(first->second))});
    }
}

void YamlBuilder::failed(size_t offset, const std::string& message) {
    if (yaml_.nodes_.size() == Yaml::node_limit) return;  // already said
    if (feed_.stopped())
        return reject(last_offset_, feed_.too_deep()
                                        ? "what follows is nested deeper than " + std::to_string(Yaml::depth_limit) + " levels"
                                        : "the bracketed collection that follows has more than " +
                                              std::to_string(Yaml::flow_limit) +
                                              " items: write its outer levels as indented lines");
    if (depth_ > Yaml::depth_limit) return;                                                 // already said
    if (message.rfind(YAML::ErrorMsg::INVALID_ESCAPE, 0) == 0 && offset >= 2) offset -= 2;  // it points behind the escape
    if (message.find("anchor") != std::string::npos || message.find("alias") != std::string::npos) {
        size_t sign = std::min(offset, yaml_.text_.size());
        if (sign > 0 && at(sign) == '\n') --sign;
        while (sign > 0 && at(sign) != '\n' && at(sign) != '&' && at(sign) != '*') --sign;
        if (property(sign)) return;
    }
    if (property(offset)) return;
    const Place place = yaml_.place_at(offset);
    const std::string line = yaml_.source_line(place);
    std::vector<std::string> notes;
    const size_t first = line.find_first_not_of(" ");
    if (first != std::string::npos && line[first] == '\t') notes.push_back("a tab cannot indent: use spaces");
    if (is_rule(line)) notes.push_back(quote_expression);
    reject(offset, "not YAML: " + plain_words(message), std::move(notes));
}

std::optional<Yaml> Yaml::parse(std::string path, std::string text, Diags& diags) {
    if (text.size() > size_limit) {
        diags.error({path, 0, 0}, "larger than 64 MiB");
        return std::nullopt;
    }
    if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
    Yaml yaml(std::move(path), std::move(text));
    Feed feed(yaml.text_);
    YamlBuilder builder(yaml, feed, diags);
    if (const Unfit unfit = find_unfit(yaml.text_); unfit.why != nullptr) {
        builder.reject(unfit.offset, unfit.why);
        return std::nullopt;
    }
    if (const size_t at = find_directive(yaml.text_); at != std::string_view::npos) {
        builder.reject(at, "'%' begins a YAML directive, which kiln does not use");
        return std::nullopt;
    }
    try {
        std::istream stream(&feed);
        YAML::Parser parser(stream);
        while (builder.documents() < 2 && parser.HandleNextDocument(builder)) {
        }
        if (feed.stopped()) builder.failed(yaml.text_.size(), "");
    } catch (const YAML::Exception& e) {
        builder.failed(e.mark.pos < 0 ? yaml.text_.size() : static_cast<size_t>(e.mark.pos), e.msg);
    } catch (const std::exception& e) {
        builder.failed(yaml.text_.size(), e.what());
    }
    if (!builder.any_errors() && yaml.nodes_.empty()) builder.reject(0, "the file is empty");
    if (builder.any_errors()) return std::nullopt;
    return yaml;
}

}  // namespace kiln
