#include "compiler/manifest/yaml.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln {
namespace {

std::string problems(const std::string& text) {
    Diags diags;
    const auto yaml = Yaml::parse("y", text, diags);
    EXPECT_EQ(yaml.has_value(), !diags.has_errors());
    diags.sort();
    std::string out;
    for (const Diag& d : diags.list())
        out += std::to_string(d.place.line) + ":" + std::to_string(d.place.column) + ": " + d.message + "\n";
    return out;
}

TEST(Yaml, RefusesWhatIsNotPlain) {
    const std::pair<std::string, const char*> table[] = {
        {"", "1:1: the file is empty\n"},
        {"# comment\n\n", "1:1: the file is empty\n"},
        {"a: !b\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: !b c\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: ! c\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: !!str c\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: !<tag:x> c\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"!b c: d\n", "1:1: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: !b [c]\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: !b\n  c: d\n", "1:4: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: [x, !b]\n", "1:8: '!' begins a YAML tag, which kiln does not use\n"},
        {"a: &b c\n", "1:4: '&' begins a YAML anchor, which kiln does not use\n"},
        {"a: &b\n", "1:4: '&' begins a YAML anchor, which kiln does not use\n"},
        {"a: &b !c d\n", "1:4: '&' begins a YAML anchor, which kiln does not use\n"},
        {"a: & b\n", "1:4: '&' begins a YAML anchor, which kiln does not use\n"},
        {"a: *b\n", "1:4: '*' begins a YAML alias, which kiln does not use\n"},
        {"a: &b c\nd: *b\n",
         "1:4: '&' begins a YAML anchor, which kiln does not use\n2:4: '*' begins a YAML alias, which kiln does not use\n"},
        {"a: *\n", "1:4: '*' begins a YAML alias, which kiln does not use\n"},
        {"<<: {a: b}\n", "1:1: '<<' is YAML's merge key, which kiln does not use\n"},
        {"'<<': b\n", ""},
        {"a: b\n\"a\": c\n", "2:1: duplicate key 'a'\n"},
        {"a: b\n? a\n: c\n", "2:3: duplicate key 'a'\n"},
        {"[a]: b\n", "1:1: a key must be a name\n"},
        {"? {a: b}\n: c\n", "1:3: a key must be a name\n"},
        {"~: b\n", "1:1: a key must be a name\n"},
        {"a: b\n---\nc: d\n", "2:1: a second document: a file holds one\n"},
        {"---\na: b\n...\n", ""},
        {"a: b\n...\nc: d\n",
         "3:1: this does not belong to what is above it: check the indentation; a file holds one document\n"},
        {"%YAML 1.2\n---\na: b\n", "1:1: '%' begins a YAML directive, which kiln does not use\n"},
        {"# c\n\n%TAG ! x\n---\na: b\n", "3:1: '%' begins a YAML directive, which kiln does not use\n"},
        {"a: 'b\n", "1:4: this quote is not closed\n"},
        {"a: \"b\\\"\n", "1:4: this quote is not closed\n"},
        {"a: 'b''\n", "1:4: this quote is not closed\n"},
        {"a: [b\n", "2:1: not YAML: expected ',' or ']' here; text that holds braces, brackets or commas needs quotes\n"},
        {"a: b: c\n", "1:5: not YAML: a ':' cannot stand here; text that holds ': ' needs quotes\n"},
        {"a: `b\n", "1:4: not YAML: text cannot begin with this character: it needs quotes\n"},
        {"a: \"\\q\"\n", "1:5: not YAML: unknown escape character: q\n"},
        {std::string("a: b\0c\n", 7), "1:5: a control character\n"},
        {"a: b\x04\nc: d\n", "1:5: a control character\n"},
        {"a: b\x1b[0m\n", "1:5: a control character\n"},
        {"a: b\x7f\n", "1:5: a control character\n"},
        {"a: b\nc: d\xff\n", "2:5: not UTF-8\n"},
        {"a: \xc3\n", "1:4: not UTF-8\n"},
        {"a: \xc0\x80\n", "1:4: not UTF-8\n"},
        {"a: \xed\xa0\x80\n", "1:4: not UTF-8\n"},
        {"a: \xf4\x90\x80\x80\n", "1:4: not UTF-8\n"},
        {"a: \xe2\x82", "1:4: not UTF-8\n"},
        {"\xff\xfe"
         "a\0",
         "1:1: not UTF-8\n"},
        {"a: b\rc: d\n", "1:5: a carriage return without a line feed\n"},
    };
    for (const auto& [text, expected] : table) EXPECT_EQ(problems(text), expected) << text;
}

TEST(Yaml, BomAndLineEndsDoNotMovePlaces) {
    for (const char* bom : {"", "\xEF\xBB\xBF"})
        for (const char* end : {"\n", "\r\n"}) {
            const std::string e = end;
            const std::string text = bom + ("a: b" + e + "\xC3\xA9: [x," + e + "   'y'," + e + "   z]" + e + "last: ~");
            Diags diags;
            const auto yaml = Yaml::parse("y", text, diags);
            ASSERT_TRUE(yaml);
            const auto pairs = yaml->pairs(0);
            ASSERT_EQ(pairs.size(), 3u);
            EXPECT_EQ(yaml->place(pairs[0].key), (Place{"y", 1, 1}));
            EXPECT_EQ(yaml->place(pairs[1].value), (Place{"y", 2, 5}));
            const auto items = yaml->items(pairs[1].value);
            ASSERT_EQ(items.size(), 3u);
            EXPECT_EQ(yaml->place(items[1]), (Place{"y", 3, 4}));
            EXPECT_EQ(yaml->value(items[1]), "y");
            EXPECT_EQ(yaml->style(items[1]), YamlStyle::single_quoted);
            EXPECT_EQ(yaml->place(items[2]), (Place{"y", 4, 4}));
            EXPECT_EQ(yaml->source_line(yaml->place(items[2])), "   z]");
            EXPECT_EQ(yaml->place(pairs[2].value), (Place{"y", 5, 7}));
            EXPECT_EQ(yaml->kind(pairs[2].value), YamlKind::null);
        }
}

// The value of key `k` and the place of each of its bytes: "a1:4 b1:5".
std::string bytes_of(const std::string& text) {
    Diags diags;
    const auto yaml = Yaml::parse("y", text, diags);
    if (!yaml) return "refused";
    const Yaml::Node node = yaml->pairs(0).at(0).value;
    std::string out;
    const std::string_view value = yaml->value(node);
    for (size_t i = 0; i <= value.size(); ++i) {
        const Place place = yaml->place_in(node, i);
        const std::string shown = i == value.size()  ? "$"
                                  : value[i] == '\n' ? "\\n"
                                  : value[i] == ' '  ? "_"
                                                     : std::string(1, value[i]);
        out += (i == 0 ? "" : " ") + shown + std::to_string(place.line) + ":" + std::to_string(place.column);
    }
    return out;
}

TEST(Yaml, PlacesInsideScalars) {
    const std::pair<const char*, const char*> table[] = {
        {"k: ab\n", "a1:4 b1:5 $1:6"},
        {"k: a\n   b\n", "a1:4 _1:5 b2:4 $2:5"},
        {"k: a  \r\n   b\r\n", "a1:4 _1:7 b2:4 $2:5"},
        {"k: a\n\n   b # c\n", "a1:4 \\n1:5 b3:4 $3:5"},
        {"k: 'a''b'\n", "a1:5 '1:6 b1:8 $1:9"},
        {"k: 'a\n  b'\n", "a1:5 _1:6 b2:3 $2:4"},
        {"k: \"a\\tb\"\n", "a1:5 \t1:6 b1:8 $1:9"},
        {"k: \"a\\x41\\u0042\\U00000043d\"\n", "a1:5 A1:6 B1:10 C1:16 d1:26 $1:27"},
        {"k: \"a\\\n  b\"\n", "a1:5 b2:3 $2:4"},
        {"k: \"a\n  b\"\n", "a1:5 _1:6 b2:3 $2:4"},
        {"k: \"\\\"\\\\x\"\n", "\"1:5 \\1:7 x1:9 $1:10"},
        {"k: |\n  ab\n  c\n", "a2:3 b2:4 \\n2:5 c3:3 \\n3:4 $4:1"},
        {"k: |-\n  ab\n   c\n\n", "a2:3 b2:4 \\n2:5 _3:3 c3:4 $3:5"},
        {"k: >\n  ab\n  c\n", "a2:3 b2:4 _2:5 c3:3 \\n3:4 $4:1"},
        {"k: >-\n  ab\n\n  c\n", "a2:3 b2:4 \\n3:1 c4:3 $4:4"},
        {"k: | # comment\r\n  ab\r\n  c\r\n", "a2:3 b2:4 \\n2:5 c3:3 \\n3:4 $3:5"},
        {"k: |2\n    a\n", "_2:3 _2:4 a2:5 \\n2:6 $3:1"},
        {"k: >-1\n  a\n b\n", "_2:2 a2:3 \\n2:4 b3:2 $3:3"},
    };
    for (const auto& [text, expected] : table) EXPECT_EQ(bytes_of(text), expected) << text;
}

// Scalars written at random in every style: each byte of the value that is no blank must be found at the place given.
TEST(Yaml, PlacesInsideRandomScalars) {
    std::mt19937 random(99);  // the seed
    const auto below = [&](unsigned n) { return static_cast<size_t>(random() % n); };
    size_t mapped = 0;
    for (int round = 0; round < 20000; ++round) {
        const char* const head[] = {"k: ",       "k: '",        "k: \"",     "k: |\n  ",   "k: >\n  ",
                                    "k: |-\n  ", "k: >+\n    ", "k: |1\n  ", "k: >2-\n   "};
        const size_t style = below(9);
        static const char* const pieces[] = {"a",   "bc", " ",  "  ",  "\n  ",  "\n\n  ", "\n    ", "\r\n  ",
                                             "(x)", "&&", "->", "\\n", "\\x41", "''",     "\\\"",   "\n   \n  "};
        std::string text = head[style];
        for (size_t i = 0; i < 1 + below(10); ++i) text += pieces[below(16)];
        text += style == 1 ? "'\n" : style == 2 ? "\"\n" : "\n";
        if (below(2) == 0) text += "l: m\n";
        Diags diags;
        const auto yaml = Yaml::parse("y", text, diags);
        if (!yaml) continue;
        const Yaml::Node node = yaml->pairs(0).at(0).value;
        if (yaml->kind(node) != YamlKind::scalar) continue;
        const std::string_view value = yaml->value(node);
        for (size_t i = 0; i < value.size(); ++i) {
            const Place place = yaml->place_in(node, i);
            if (place == yaml->place(node) && i > 0) continue;  // not known
            const std::string_view line = line_of(text, place.line);
            ASSERT_LE(place.column, line.size() + 1) << text;
            if (value[i] == ' ' || value[i] == '\n') continue;
            const char there = line[place.column - 1];
            ASSERT_TRUE(there == value[i] || (there == '\\' && style == 2)) << text << "\nbyte " << i << " of " << value;
            ++mapped;
        }
    }
    EXPECT_GT(mapped, 40000u);
}

TEST(Yaml, HostileShapesEndSoon) {
    const auto many = [](const std::string& unit, size_t n) {
        std::string out;
        out.reserve(unit.size() * n);
        for (size_t i = 0; i < n; ++i) out += unit;
        return out;
    };
    const std::string deep = ": nested deeper than 64 levels\n";
    EXPECT_NE(problems("a: " + many("[", 300000)).find(deep), std::string::npos);
    EXPECT_NE(problems(many("[a,\n", 300000)).find(deep), std::string::npos);
    EXPECT_NE(problems(many("{a: ", 300000)).find(deep), std::string::npos);
    EXPECT_NE(problems(many("- ", 300000)).find(deep), std::string::npos);
    EXPECT_NE(problems(many("? ", 300000)).find(deep), std::string::npos);
    std::string stairs;
    for (size_t i = 0; i < 2000; ++i) stairs += std::string(i, ' ') + "k:\n";
    EXPECT_EQ(problems(stairs), "65:65" + deep);
    std::string fits;
    for (size_t i = 0; i < 63; ++i) fits += std::string(i, ' ') + "k:\n";
    EXPECT_EQ(problems(fits + std::string(63, ' ') + "k: v\n"), "");
    EXPECT_EQ(
        problems("[a: 1,\n" + many("b,\n", Yaml::flow_limit + 2000) + "]"),
        "1:1: the bracketed collection that follows has more than 2097152 items: write its outer levels as indented lines\n");
    EXPECT_EQ(problems(std::string(Yaml::size_limit + 1, ' ')), "0:0: larger than 64 MiB\n");
    EXPECT_EQ(problems(many("\n", 1 << 20)), "1:1: the file is empty\n");
    EXPECT_EQ(problems("a: " + std::string(1 << 20, 'x')), "");
    EXPECT_EQ(problems("a: \"" + many("\\x41", 1 << 18) + "\""), "");
}

TEST(Yaml, LongLinesAreShownInPart) {
    Diags diags;
    EXPECT_FALSE(Yaml::parse("y", "a: [" + std::string(3000, 'x') + ", !b, " + std::string(100000, 'y') + ", !b]", diags));
    ASSERT_EQ(diags.list().size(), 2u);
    EXPECT_EQ(diags.list()[0].place.column, 3007u);
    EXPECT_LT(diags.list()[0].source_line.size(), 4000u);
    EXPECT_EQ(diags.list()[1].source_line, "");
}

}  // namespace
}  // namespace kiln
