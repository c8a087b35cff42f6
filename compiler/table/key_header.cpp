// The header uses nothing but <cstdint>, so that a game can include it without linking anything. Names of axes and values
// are identifiers by the manifest's grammar except for integers and for words that C++ keeps for itself: those get a prefix
// or an underscore.

#include <set>
#include <sstream>

#include "compiler/table/key_layout.h"
#include "compiler/table/table.h"

namespace kiln {

namespace {

const std::set<std::string_view> keywords = {
    "alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
    "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
    "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
    "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
    "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
    "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
    "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
    "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
    "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
    "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
    "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
    "true",        "try",      "typedef",    "typeid",    "typename",  "union",        "unsigned",
    "using",       "virtual",  "void",       "volatile",  "wchar_t",   "while",        "xor",
    "xor_eq"};

// A C++ identifier for a name; `taken` keeps the identifiers of one scope apart.
std::string identifier(const std::string& name, std::set<std::string>& taken) {
    std::string out;
    for (const char c : name) {
        const bool word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        if (c == '-' && out.empty())
            out += "minus_";
        else
            out += word ? c : '_';
    }
    if (out.empty() || (out[0] >= '0' && out[0] <= '9') || out.rfind("minus_", 0) == 0) out = "n" + out;
    // A leading underscore or a double one is the implementation's.
    std::string plain;
    for (const char c : out)
        if (c != '_' || plain.empty() || plain.back() != '_') plain += c;
    if (plain[0] == '_') plain = "u" + plain;
    if (keywords.count(plain) != 0) plain += '_';
    std::string unique = plain;
    for (unsigned i = 2; !taken.insert(unique).second; ++i) unique = plain + "_" + std::to_string(i);
    return unique;
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) == 127)
            out += '?';
        else
            out += c;
    }
    return out + "\"";
}

void write_axis(std::ostream& out, const Axis& axis, const std::string& name, const KeyField& field) {
    std::set<std::string> taken;
    out << "enum class " << name << "_axis : std::uint32_t {\n";
    for (size_t v = 0; v < axis.values.size(); ++v)
        out << "    " << identifier(axis.values[v].name, taken) << " = " << v << ",\n";
    out << "};\n";
    out << "struct " << name << "_field {\n"
        << "    static constexpr const char* name = " << quoted(axis.name) << ";\n"
        << "    static constexpr std::uint32_t word = " << field.word << ", shift = " << field.shift << ", bits = " << field.bits
        << ", values = " << axis.values.size() << ";\n"
        << "    static constexpr std::uint64_t mask = 0x" << std::hex << ((uint64_t{1} << field.bits) - 1) << std::dec << "u;\n"
        << "};\n"
        << "static_assert(" << name << "_field::shift + " << name << "_field::bits <= 64 && " << name
        << "_field::values - 1 <= " << name << "_field::mask, \"field of \" " << quoted(axis.name) << ");\n";
}

void write_shader(std::ostream& out, const Space& space, const std::string& name) {
    const KeyLayout layout = key_layout(space.axes);
    std::set<std::string> taken{"Key", "Variant", "key_words", "shader_name"};
    std::vector<std::string> names;
    for (const Axis& axis : space.axes) {
        const std::string id = identifier(axis.name, taken);
        taken.insert(id + "_axis");
        taken.insert(id + "_field");
        names.push_back(id);
    }
    out << "namespace " << name << " {\n\n"
        << "inline constexpr const char* shader_name = " << quoted(space.shader) << ";\n"
        << "inline constexpr std::uint32_t key_words = " << layout.masks.size() << ";\n\n";
    for (size_t i = 0; i < names.size(); ++i) write_axis(out, space.axes[i], names[i], layout.fields[i]);
    out << "\n// What kiln_find and its sisters take: pass `words`.\n"
        << "struct Key {\n    std::uint64_t words[key_words];\n"
        << "    friend constexpr bool operator==(const Key& a, const Key& b) {\n"
        << "        for (std::uint32_t i = 0; i < key_words; ++i)\n"
        << "            if (a.words[i] != b.words[i]) return false;\n"
        << "        return true;\n    }\n"
        << "    friend constexpr bool operator!=(const Key& a, const Key& b) { return !(a == b); }\n};\n\n"
        << "// A variant by name; every axis starts at its first value.\n"
        << "struct Variant {\n";
    for (const std::string& n : names) out << "    " << n << "_axis " << n << " = {};\n";
    out << "    constexpr Key key() const {\n        Key k{};\n";
    for (const std::string& n : names)
        out << "        k.words[" << n << "_field::word] |= (static_cast<std::uint64_t>(" << n << ") & " << n
            << "_field::mask) << " << n << "_field::shift;\n";
    out << "        return k;\n    }\n"
        << "    static constexpr Variant of([[maybe_unused]] const Key& k) {\n        Variant v{};\n";
    for (const std::string& n : names)
        out << "        v." << n << " = static_cast<" << n << "_axis>(k.words[" << n << "_field::word] >> " << n
            << "_field::shift & " << n << "_field::mask);\n";
    out << "        return v;\n    }\n};\n";
    // The last value of every axis fills its field and no other.
    out << "static_assert(Variant::of(Variant{}.key()).key() == Key{}, \"the first values are the zero key\");\n";
    for (size_t i = 0; i < names.size(); ++i) {
        const size_t last = space.axes[i].values.size() - 1;
        out << "static_assert([] { Variant v{}; v." << names[i] << " = static_cast<" << names[i] << "_axis>(" << last
            << "); return v.key().words[" << layout.fields[i].word << "] == std::uint64_t{" << last << "} << "
            << layout.fields[i].shift << "; }(), \"\");\n";
    }
    out << "\n}  // namespace " << name << "\n";
}

}  // namespace

std::string write_key_header(const TableInput& input) {
    std::ostringstream out;
    out << "#pragma once\n// Keys of the variant table " << quoted(input.manifest->name)
        << ", written by kiln; do not edit. Needs C++17. The bit fields belong to one\n// build of the table: include the header "
           "that"
           " was written with it.\n#include <cstdint>\n\n";
    std::set<std::string> files, shaders;
    out << "namespace kiln_keys::" << identifier(input.manifest->name, files) << " {\n\n";
    std::vector<const Space*> spaces;
    for (const auto& stages : stages_by_shader(input.stages)) spaces.push_back(input.stages[stages[0]].space);
    spaces.insert(spaces.end(), input.left_out.begin(), input.left_out.end());
    for (const Space* space : spaces) {
        write_shader(out, *space, identifier(space->shader, shaders));
        out << "\n";
    }
    std::set<std::string> again;
    out << "}  // namespace kiln_keys::" << identifier(input.manifest->name, again) << "\n";
    return out.str();
}

}  // namespace kiln
