#pragma once
// YAML text as a compact tree with exact places, for manifests and scenes. Only the plain part of YAML passes: maps with
// unlike scalar keys, sequences, scalars. Tags, anchors, aliases, merge keys, directives, further documents, control
// characters and text that is not UTF-8 are errors. A BOM and CRLF line ends are accepted and do not move columns.
//
// Limits: 64 MiB of text, 64 levels, `node_limit` keys, values and collections, and `flow_limit` items in one bracketed
// collection ([...] or {...}) with all that it holds.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/diag.h"

namespace kiln {

enum class YamlKind : uint8_t { null, scalar, sequence, map };
enum class YamlStyle : uint8_t { plain, single_quoted, double_quoted, block };

struct YamlSpot {
    uint32_t line = 0, column = 0;
};

class Yaml {
public:
    static constexpr size_t size_limit = size_t{64} << 20;
    static constexpr size_t depth_limit = 64;
    static constexpr size_t node_limit = size_t{6} << 20;
    static constexpr size_t flow_limit = size_t{1} << 21;

    using Node = uint32_t;  // index; the root is 0
    struct Pair {
        Node key;  // always a scalar
        Node value;
    };

    // nullopt after an error. `path` is only used in places.
    static std::optional<Yaml> parse(std::string path, std::string text, Diags& diags);

    YamlKind kind(Node n) const { return nodes_[n].kind; }
    YamlStyle style(Node n) const { return nodes_[n].style; }
    bool is_plain(Node n) const { return kind(n) == YamlKind::scalar && style(n) == YamlStyle::plain; }
    std::string_view value(Node n) const;  // of a scalar, escapes and folding undone; empty for other kinds
    size_t size(Node n) const { return nodes_[n].size; }
    std::vector<Node> items(Node sequence) const;
    std::vector<Pair> pairs(Node map) const;

    YamlSpot spot(Node n) const { return spot_at(nodes_[n].offset); }
    Place place(Node n) const { return place_at(nodes_[n].offset); }
    // Of byte `value_offset` of a scalar's value, wherever quoting, escapes and folding have put it in the file.
    Place place_in(Node n, size_t value_offset) const;
    const std::string& text() const { return text_; }  // without its BOM
    // The line of a place of this file; shortened, or empty, when it is far too long to show.
    std::string source_line(const Place& place) const;

private:
    friend class YamlBuilder;
    struct Entry {
        uint32_t offset = 0;  // in text_
        uint32_t next = 0;    // sibling; 0: none. A map's children alternate key, value
        uint32_t begin = 0;   // scalar: of the value in text_ or decoded_. Else: the first child, 0 for none
        uint32_t size = 0;    // scalar: bytes. Else: items or pairs
        YamlKind kind = YamlKind::null;
        YamlStyle style = YamlStyle::plain;
        bool decoded = false;  // the value differs from the text and is in decoded_
    };

    Yaml(std::string path, std::string text);
    YamlSpot spot_at(size_t offset) const;
    Place place_at(size_t offset) const;

    std::string path_;
    std::string text_;     // without its BOM
    std::string decoded_;  // values that are not verbatim in text_
    std::vector<Entry> nodes_;
    struct Mark {
        uint32_t line, line_begin;  // the line's number, and the offset where it begins
    };
    std::vector<Mark> marks_;  // at every so many bytes of text
};

// Collects a file's mistakes with source lines; after `limit` of them it says once that there are more.
class YamlErrors {
public:
    static constexpr size_t limit = 200;
    YamlErrors(const Yaml& yaml, Diags& diags) : yaml_(yaml), diags_(diags) {}
    void at(const Place& place, std::string message, std::vector<std::string> notes = {});
    void at(Yaml::Node n, std::string message, std::vector<std::string> notes = {}) {
        at(yaml_.place(n), std::move(message), std::move(notes));
    }
    bool any() const { return count_ != 0; }
    size_t count() const { return count_; }
    bool full() const { return count_ > limit; }  // what is reported from here on is not shown

private:
    const Yaml& yaml_;
    Diags& diags_;
    size_t count_ = 0;
};

// "file:3:7", for messages that name a second place.
std::string to_string(const Place& place);

// Where every byte of a scalar's value stands in the text, by decoding the scalar that begins at `offset` again; one more
// entry for its end. Empty when the decoding does not give `value` (then only the scalar's start is known).
std::vector<uint32_t> scalar_offsets(std::string_view text, size_t offset, YamlStyle style, std::string_view value);

}  // namespace kiln
