#pragma once
// Reads a map with a known set of keys: unknown ones are errors with the nearest right one, and wrong kinds of value say what was
// expected. Every function reports through `errors` and answers nullopt for what is absent or wrong.

#include <initializer_list>

#include "compiler/base/files.h"
#include "compiler/manifest/yaml.h"

namespace kiln {

class Fields {
public:
    // `what` begins messages: "a shader". A node that is no map is an error here, and then has no keys.
    Fields(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, std::string what, std::initializer_list<const char*> known);

    const Yaml::Pair* find(std::string_view key) const;
    bool is_map() const { return is_map_; }
    // An error at the map when the key is absent.
    const Yaml::Pair* need(std::string_view key);

private:
    const Yaml& yaml_;
    YamlErrors& errors_;
    Yaml::Node node_;
    std::string what_;
    bool is_map_ = false;
    std::vector<Yaml::Pair> pairs_;
};

// "a list", "a map", "empty", "text": for messages.
std::string describe(const Yaml& yaml, Yaml::Node node);

// The text of the file to read, or an error about it.
std::optional<std::string> read_source(Files& files, const std::string& path, Diags& diags);

// A non-empty scalar's text of one line, without control characters.
std::optional<std::string> read_text(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what);
// A non-empty scalar's text, with line ends and tabs as spaces (byte for byte, so that offsets stay), none at its end.
std::optional<std::string> read_prose(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what);
// true or false, plain.
std::optional<bool> read_bool(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what);
// One of `names`; an error gives the nearest. The index.
std::optional<size_t> read_choice(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what,
                                  const std::vector<std::string>& names);
// A sequence's items; an error when it is none.
std::vector<Yaml::Node> read_list(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what);

// [A-Za-z_][A-Za-z0-9_]*
bool is_identifier(std::string_view text);
// In quotes, on one line, cut when very long.
std::string quoted(std::string_view text);
// A path's last part without its ending.
std::string stem_of(const std::string& path);

}  // namespace kiln
