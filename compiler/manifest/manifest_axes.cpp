// Axes and their values. YAML 1.1's other words for booleans (yes, no, on, off, y, n) are plain names here: a value is what
// is written, so that a list like [off, low, high] means what it says.
#include <unordered_map>

#include "compiler/manifest/manifest_parts.h"

namespace kiln {

namespace {

// Finds a second use of a name or a number, and remembers where the first was.
template <class Key>
class Seen {
public:
    // The node of the first use, or nullopt when this is it.
    std::optional<Yaml::Node> earlier(const Key& key, Yaml::Node node) {
        const auto [at, fresh] = first_.emplace(key, node);
        return fresh ? std::nullopt : std::optional(at->second);
    }
    void reserve(size_t n) { first_.reserve(n); }

private:
    std::unordered_map<Key, Yaml::Node> first_;
};

class AxisReader {
public:
    AxisReader(ManifestText in, Axis& axis) : in_(in), axis_(axis), what_("axis " + quoted(axis.name)) {}

    void read(Yaml::Node node) {
        Fields fields(in_.yaml, in_.errors, node, what_, {"macro", "values"});
        if (const auto* macro = fields.need("macro")) read_macro(macro->value);
        if (const auto* values = fields.need("values")) read_values(values->value);
    }

private:
    void read_macro(Yaml::Node node) {
        const auto name = read_text(in_.yaml, in_.errors, node, "the macro of " + what_);
        if (!name) return;
        if (const char* const problem = macro_problem(*name))
            return in_.errors.at(node, "the macro " + quoted(*name) + " " + problem);
        axis_.macro = *name;
    }

    void read_values(Yaml::Node node) {
        switch (in_.yaml.kind(node)) {
            case YamlKind::null:
                return in_.errors.at(node,
                                     what_ + " has no values: write a list, a map of names to integers, 'bool' or 'defined'");
            case YamlKind::scalar:
                return word(node);
            case YamlKind::sequence:
                return list(node);
            case YamlKind::map:
                return map(node);
        }
    }

    void word(Yaml::Node node) {
        const auto choice = read_choice(in_.yaml, in_.errors, node, "the values of " + what_, {"bool", "defined"});
        if (!choice) return;
        axis_.kind = *choice == 0 ? AxisKind::boolean : AxisKind::defined;
        axis_.values.push_back({"false", 0});
        axis_.values.push_back({"true", 1});
    }

    bool room(Yaml::Node node) {
        const size_t count = in_.yaml.size(node);
        if (count == 0) in_.errors.at(node, what_ + " has an empty list of values");
        if (count > axis_value_limit)
            in_.errors.at(node, what_ + " has " + std::to_string(count) + " values; at most " + std::to_string(axis_value_limit) +
                                    " are possible");
        axis_.values.reserve(count);
        numbers_.reserve(count);
        return count != 0 && count <= axis_value_limit;
    }

    void list(Yaml::Node node) {
        if (!room(node)) return;
        std::optional<Yaml::Node> first_name, first_integer;
        for (const Yaml::Node item : in_.yaml.items(node)) {
            const bool digits = looks_integer(item);
            auto& first = digits ? first_integer : first_name;
            const std::optional<Yaml::Node> other = digits ? first_name : first_integer;
            if (other && !first)
                in_.errors.at(
                    item, "names and integers do not mix in one list; number the names by hand: {none: 0, one: 1}",
                    {"the list begins with " + quoted(in_.yaml.value(*other)) + " at " + to_string(in_.yaml.place(*other))});
            if (!first && in_.yaml.kind(item) == YamlKind::scalar) first = item;
            const bool mixed = first_name && first_integer;
            const ParsedInteger integer = parse_integer(in_.yaml.value(item));
            if (digits && integer.problem != nullptr) {
                in_.errors.at(item, quoted(in_.yaml.value(item)) + ": " + integer.problem);
            } else if (digits) {
                if (!mixed) add(item, std::to_string(integer.number), integer.number);
            } else if (const auto name = value_name(item); name && !mixed) {
                add(item, *name, static_cast<int32_t>(axis_.values.size()));
            }
        }
        axis_.kind = first_integer ? AxisKind::integer : AxisKind::named;
    }

    void map(Yaml::Node node) {
        if (!room(node)) return;
        axis_.kind = AxisKind::named;
        for (const Yaml::Pair& pair : in_.yaml.pairs(node)) {
            const auto name = value_name(pair.key);
            const std::string_view text = in_.yaml.value(pair.value);
            const ParsedInteger integer = parse_integer(text);
            if (looks_integer(pair.value) && integer.problem == nullptr) {
                if (name) add(pair.key, *name, integer.number);
            } else if (looks_integer(pair.value)) {
                in_.errors.at(pair.value, quoted(text) + ": " + integer.problem);
            } else if (in_.yaml.is_plain(pair.value) && is_identifier(text) && text != "true" && text != "false") {
                in_.errors.at(pair.value,
                              "values are integers: a value that is a token, like " + quoted(text) + ", is not supported",
                              {"give it a number and choose the token in the shader: #if " +
                               (axis_.macro.empty() ? std::string("MACRO") : axis_.macro) + " == 0"});
            } else {
                in_.errors.at(pair.value, "a value must be an integer, this is " + describe(in_.yaml, pair.value));
            }
        }
    }

    // Plain text that was meant as a number.
    bool looks_integer(Yaml::Node node) const {
        if (!in_.yaml.is_plain(node)) return false;
        const std::string_view text = in_.yaml.value(node);
        const size_t sign = text.front() == '-' || text.front() == '+' ? 1 : 0;
        return text.size() > sign && text[sign] >= '0' && text[sign] <= '9';
    }

    std::optional<std::string> value_name(Yaml::Node node) {
        if (in_.yaml.kind(node) == YamlKind::null) {
            in_.errors.at(node, "a value of " + what_ + " is empty: 'null', '~' and nothing are no names");
            return std::nullopt;
        }
        if (in_.yaml.kind(node) != YamlKind::scalar) {
            const bool pair = in_.yaml.kind(node) == YamlKind::map && in_.yaml.size(node) == 1;
            in_.errors.at(node, "a value must be a name or an integer, this is " + describe(in_.yaml, node),
                          pair ? std::vector<std::string>{"to number values by hand write a map: values: {none: 0, one: 1}"}
                               : std::vector<std::string>{});
            return std::nullopt;
        }
        const std::string_view text = in_.yaml.value(node);
        if (text == "true" || text == "false") {
            in_.errors.at(node, quoted(text) + " cannot be the name of a value: write 'values: bool' for false and true");
            return std::nullopt;
        }
        if (!is_identifier(text)) {
            in_.errors.at(
                node, quoted(text) + " cannot be the name of a value: names are letters, digits and '_', and begin with no digit",
                parse_integer(text).problem == nullptr ? std::vector<std::string>{"write an integer without quotes"}
                                                       : std::vector<std::string>{});
            return std::nullopt;
        }
        if (text.size() > name_limit) {
            in_.errors.at(node, "a name may have at most " + std::to_string(name_limit) + " bytes");
            return std::nullopt;
        }
        return std::string(text);
    }

    void add(Yaml::Node node, std::string name, int32_t number) {
        if (const auto earlier = names_.earlier(name, node))
            return in_.errors.at(node, "duplicate value " + quoted(name) + " of " + what_,
                                 {"first at " + to_string(in_.yaml.place(*earlier))});
        if (const auto earlier = numbers_.earlier(number, node))
            return in_.errors.at(node,
                                 quoted(name) + " of " + what_ + " has the same number as " + quoted(in_.yaml.value(*earlier)) +
                                     ": " + std::to_string(number),
                                 {"first at " + to_string(in_.yaml.place(*earlier))});
        const YamlSpot spot = in_.yaml.spot(node);
        axis_.values.push_back({std::move(name), number, spot.line, spot.column});
    }

    ManifestText in_;
    Axis& axis_;
    std::string what_;
    Seen<std::string> names_;
    Seen<int32_t> numbers_;
};

}  // namespace

const char* macro_problem(std::string_view name) {
    if (!is_identifier(name)) return "is no identifier: letters, digits and '_', beginning with no digit";
    if (name == "defined") return "is an operator of #if";
    if (name == "VULKAN") return "is defined by the compiler";
    if (name.substr(0, 3) == "GL_") return "is reserved: names that begin with 'GL_' belong to GLSL";
    if (name.find("__") != std::string_view::npos) return "is reserved: names with '__' belong to the compiler";
    if (name.size() > name_limit) return "is longer than 255 bytes";
    return nullptr;
}

std::vector<Axis> read_axes(ManifestText in, Yaml::Node node) {
    std::vector<Axis> axes;
    if (in.yaml.kind(node) != YamlKind::map) {
        in.errors.at(node, "axes must be a map of names to axes, this is " + describe(in.yaml, node));
        return axes;
    }
    if (in.yaml.size(node) > axis_limit) {
        in.errors.at(node, std::to_string(in.yaml.size(node)) + " axes; at most " + std::to_string(axis_limit) + " are possible");
        return axes;
    }
    std::unordered_map<std::string, size_t> macros;  // -> index of the axis that has it
    size_t values = 0;
    for (const Yaml::Pair& pair : in.yaml.pairs(node)) {
        const std::string_view name = in.yaml.value(pair.key);
        if (!is_identifier(name) || name.size() > name_limit)
            in.errors.at(pair.key,
                         quoted(name) +
                             " cannot be the name of an axis: names are letters, digits and '_', begin with no digit, and "
                             "have at most " +
                             std::to_string(name_limit) + " bytes");
        else if (name == "in" || name == "not" || name == "true" || name == "false")
            in.errors.at(pair.key, quoted(name) + " cannot be the name of an axis: it is a word of rule expressions");
        Axis axis;
        axis.name = std::string(name);
        axis.place = in.yaml.place(pair.key);
        axis.source_line = in.yaml.source_line(axis.place);
        AxisReader(in, axis).read(pair.value);
        values += axis.values.size();
        if (!axis.macro.empty()) {
            const auto [first, fresh] = macros.emplace(axis.macro, axes.size());
            if (!fresh)
                in.errors.at(axis.place,
                             "axis " + quoted(name) + " has the macro " + quoted(axis.macro) + " of axis " +
                                 quoted(axes[first->second].name),
                             {"first at " + to_string(axes[first->second].place)});
        }
        axes.push_back(std::move(axis));
        if (values > value_limit) {
            in.errors.at(node, "more than " + std::to_string(value_limit) + " values in all");
            break;
        }
    }
    return axes;
}

}  // namespace kiln
