#include "tools/args.h"

#include <algorithm>

#include "compiler/base/diag.h"

namespace kiln {

namespace {

Error usage_error(std::string message) { return {Fault::usage, std::move(message)}; }

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
    const std::string near = nearest(word, names);
    return near.empty() ? "" : "; did you mean '" + near + "'?";
}

}  // namespace

Result<Args> Args::parse(const Verb& verb, const std::vector<std::string>& words) {
    Args args;
    bool plain_only = false;
    for (size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (plain_only || word.size() < 2 || word[0] != '-') {
            args.words_.push_back(word);
            continue;
        }
        if (word == "--") {
            plain_only = true;
            continue;
        }
        const bool is_long = word[1] == '-';
        const size_t equals = is_long ? word.find('=') : std::string::npos;
        const std::string name = is_long ? word.substr(0, equals) : word.substr(0, 2);
        const auto option = std::find_if(verb.options.begin(), verb.options.end(), [&](const Option& o) {
            return name == o.name || (o.letter != nullptr && name == o.letter);
        });
        if (option == verb.options.end()) {
            std::vector<std::string> names;
            for (const Option& o : verb.options) names.emplace_back(o.name);
            return usage_error(std::string("kiln ") + verb.name + ": unknown option '" + name + "'" + did_you_mean(name, names));
        }
        std::string value;
        if (option->value == nullptr) {
            if (equals != std::string::npos || (!is_long && word.size() > 2))
                return usage_error(std::string("kiln ") + verb.name + ": " + option->name + " takes no value");
        } else if (equals != std::string::npos) {
            value = word.substr(equals + 1);
        } else if (!is_long && word.size() > 2) {
            value = word.substr(2);
        } else if (i + 1 < words.size()) {
            value = words[++i];
        } else {
            return usage_error(std::string("kiln ") + verb.name + ": " + option->name + " needs a value (" + option->value + ")");
        }
        if (!option->repeats && args.has(option->name))
            return usage_error(std::string("kiln ") + verb.name + ": " + option->name + " is given twice");
        args.options_.emplace_back(option->name, std::move(value));
    }
    if (args.words_.size() < verb.least)
        return usage_error(std::string("kiln ") + verb.name + ": missing argument; usage: kiln " + verb.name + " " + verb.usage);
    if (args.words_.size() > verb.most)
        return usage_error(std::string("kiln ") + verb.name + ": unexpected argument '" + args.words_[verb.most] +
                           "'; usage: kiln " + verb.name + " " + verb.usage);
    return args;
}

bool Args::has(std::string_view name) const {
    return std::any_of(options_.begin(), options_.end(), [&](const auto& o) { return o.first == name; });
}

std::string Args::value(std::string_view name, std::string fallback) const {
    for (const auto& [key, given] : options_)
        if (key == name) return given;
    return fallback;
}

std::vector<std::string> Args::values(std::string_view name) const {
    std::vector<std::string> out;
    for (const auto& [key, given] : options_)
        if (key == name) out.push_back(given);
    return out;
}

Result<uint64_t> Args::number(std::string_view name, uint64_t fallback, uint64_t least, uint64_t most) const {
    if (!has(name)) return fallback;
    const std::string text = value(name);
    const bool digits = !text.empty() && text.size() <= 18 && text.find_first_not_of("0123456789") == std::string::npos;
    const uint64_t number = digits ? std::stoull(text) : 0;
    if (!digits || number < least || number > most)
        return usage_error(std::string(name) + " takes a whole number from " + std::to_string(least) + " to " +
                           std::to_string(most) + ", not '" + text + "'");
    return number;
}

std::string help_of(const Verb& verb) {
    std::string out = std::string("kiln ") + verb.name + " " + verb.usage + "\n\n" + verb.summary + "\n";
    size_t width = 0;
    const auto left = [](const Option& o) {
        std::string text = o.letter != nullptr ? std::string(o.letter) + ", " : "    ";
        text += o.name;
        if (o.value != nullptr) text += std::string(" ") + o.value;
        return text;
    };
    for (const Option& o : verb.options) width = std::max(width, left(o).size());
    if (!verb.options.empty()) out += "\noptions:\n";
    for (const Option& o : verb.options) {
        const std::string text = left(o);
        out += "  " + text + std::string(width - text.size() + 2, ' ') + o.help + (o.repeats ? " (may repeat)" : "") + "\n";
    }
    if (verb.example != nullptr) out += std::string("\nexample:\n  ") + verb.example + "\n";
    return out;
}

std::string help_of(const std::vector<Verb>& verbs) {
    std::string out =
        "kiln compiles uber shaders and a manifest into one table of variants, and runs every variant.\n\n"
        "usage: kiln VERB ...\n\nverbs:\n";
    size_t width = 0;
    for (const Verb& verb : verbs)
        if (!verb.hidden) width = std::max(width, std::string(verb.name).size());
    for (const Verb& verb : verbs)
        if (!verb.hidden)
            out +=
                std::string("  ") + verb.name + std::string(width - std::string(verb.name).size() + 2, ' ') + verb.summary + "\n";
    out +=
        "\nkiln VERB --help shows a verb's options and an example; kiln help environment the\n"
        "variables that it reads; kiln --version the version.\n"
        "exit codes: 0 ok, 1 the input is wrong, 2 usage, 3 the environment failed, 4 a check found a mismatch\n"
        "\nexample:\n  kiln count manifests/surface.yaml\n";
    return out;
}

}  // namespace kiln
