#include "compiler/manifest/yaml_fields.h"

#include <algorithm>

#include "compiler/manifest/expr.h"

namespace kiln {

Fields::Fields(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, std::string what, std::initializer_list<const char*> known)
    : yaml_(yaml), errors_(errors), node_(node), what_(std::move(what)), is_map_(yaml.kind(node) == YamlKind::map) {
    if (!is_map_) {
        errors_.at(node, what_ + " must be a map, this is " + describe(yaml, node));
        return;
    }
    pairs_ = yaml.pairs(node);
    const std::vector<std::string> names(known.begin(), known.end());
    for (const Yaml::Pair& pair : pairs_) {
        if (errors_.full()) break;
        const std::string_view key = yaml.value(pair.key);
        bool found = false;
        for (const std::string& name : names) found = found || name == key;
        if (!found) errors_.at(pair.key, "unknown key " + quoted(key) + " in " + what_ + did_you_mean(key, names));
    }
}

const Yaml::Pair* Fields::find(std::string_view key) const {
    for (const Yaml::Pair& pair : pairs_)
        if (yaml_.value(pair.key) == key) return &pair;
    return nullptr;
}

const Yaml::Pair* Fields::need(std::string_view key) {
    const Yaml::Pair* const pair = find(key);
    if (pair == nullptr && is_map_) errors_.at(node_, what_ + " needs '" + std::string(key) + "'");
    return pair;
}

std::string describe(const Yaml& yaml, Yaml::Node node) {
    switch (yaml.kind(node)) {
        case YamlKind::null:
            return "empty";
        case YamlKind::scalar:
            return "the text " + quoted(yaml.value(node));
        case YamlKind::sequence:
            return "a list";
        case YamlKind::map:
            return "a map";
    }
    return {};
}

std::optional<std::string> read_source(Files& files, const std::string& path, Diags& diags) {
    Result<std::optional<std::string>> text = files.read(path);
    if (text && *text) return std::move(*text);
    std::string message = text ? "no such file" : text.error().message;
    if (message.rfind(path + ": ", 0) == 0) message.erase(0, path.size() + 2);
    diags.error({path, 0, 0}, std::move(message));
    return std::nullopt;
}

namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

// The scalar's text, or an error; `spaces` turns line ends and tabs into spaces.
std::optional<std::string> read_scalar(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what,
                                       bool spaces) {
    const bool scalar = yaml.kind(node) == YamlKind::scalar;
    std::string text(yaml.value(node));
    if (spaces) {
        for (char& c : text)
            if (c == '\n' || c == '\r' || c == '\t') c = ' ';
        text.erase(text.find_last_not_of(' ') + 1);
    }
    const auto control = std::find_if(text.begin(), text.end(), is_control);
    if (control != text.end())
        errors.at(yaml.place_in(node, static_cast<size_t>(control - text.begin())),
                  *control == '\n' ? what + " must be on one line" : what + " has a control character");
    else if (!scalar || text.empty())
        errors.at(node, what + " must be text, this is " + (scalar ? std::string("empty") : describe(yaml, node)));
    else
        return text;
    return std::nullopt;
}

}  // namespace

std::optional<std::string> read_text(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what) {
    return read_scalar(yaml, errors, node, what, false);
}

std::optional<std::string> read_prose(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what) {
    return read_scalar(yaml, errors, node, what, true);
}

std::optional<bool> read_bool(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what) {
    if (yaml.is_plain(node) && yaml.value(node) == "true") return true;
    if (yaml.is_plain(node) && yaml.value(node) == "false") return false;
    errors.at(node, what + " must be true or false, this is " + describe(yaml, node));
    return std::nullopt;
}

std::optional<size_t> read_choice(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what,
                                  const std::vector<std::string>& names) {
    const std::optional<std::string> text = read_text(yaml, errors, node, what);
    if (!text) return std::nullopt;
    for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == *text) return i;
    std::string all;
    for (size_t i = 0; i < names.size(); ++i) all += (i == 0 ? "" : ", ") + names[i];
    errors.at(node, what + " cannot be " + quoted(*text) + did_you_mean(*text, names),
              names.size() > 8 ? std::vector<std::string>{"one of: " + all} : std::vector<std::string>{});
    return std::nullopt;
}

std::vector<Yaml::Node> read_list(const Yaml& yaml, YamlErrors& errors, Yaml::Node node, const std::string& what) {
    if (yaml.kind(node) != YamlKind::sequence) errors.at(node, what + " must be a list, this is " + describe(yaml, node));
    return yaml.items(node);
}

bool is_identifier(std::string_view text) {
    if (text.empty()) return false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
        if (!letter && (i == 0 || c < '0' || c > '9')) return false;
    }
    return true;
}

std::string stem_of(const std::string& path) {
    const size_t slash = path.rfind('/');
    const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
    const size_t dot = file.rfind('.');
    return dot == std::string::npos || dot == 0 ? file : file.substr(0, dot);
}

std::string quoted(std::string_view text) {
    constexpr size_t longest = 64;
    size_t size = std::min(text.size(), longest);
    while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0) == 0x80) --size;
    std::string out = "'";
    for (const char c : text.substr(0, size)) out += is_control(c) ? ' ' : c;
    return out + (size < text.size() ? "...'" : "'");
}

}  // namespace kiln
