#include "tools/select.h"

#include <algorithm>

namespace kiln {

namespace {

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
    const std::string near = nearest(word, names);
    if (!near.empty()) return "; did you mean '" + near + "'?";
    std::string out = "; there is";
    for (size_t i = 0; i < names.size() && i < 12; ++i) out += (i == 0 ? " '" : ", '") + names[i] + "'";
    return names.empty() ? "" : out + (names.size() > 12 ? ", …" : "");
}

std::optional<uint32_t> digit_named(const Axis& axis, const std::string& value) {
    for (uint32_t d = 0; d < axis.values.size(); ++d) {
        if (axis.values[d].name == value) return d;
        const bool flag = axis.kind == AxisKind::boolean || axis.kind == AxisKind::defined;
        if (flag && value == std::to_string(axis.values[d].number)) return d;
    }
    return std::nullopt;
}

}  // namespace

Result<Selection> parse_selection(const std::vector<Axis>& axes, const std::vector<std::string>& words, size_t first) {
    Selection selection(axes.size());
    for (size_t i = first; i < words.size(); ++i) {
        const size_t equals = words[i].find('=');
        if (equals == std::string::npos) return Error{Fault::usage, "'" + words[i] + "': expected axis=value"};
        const std::string name = words[i].substr(0, equals);
        const std::string value = words[i].substr(equals + 1);
        const auto axis = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == name; });
        if (axis == axes.end()) {
            std::vector<std::string> names;
            for (const Axis& a : axes) names.push_back(a.name);
            return input_error("no axis '" + name + "'" + suggestion(name, names));
        }
        const auto digit = digit_named(*axis, value);
        if (!digit) {
            std::vector<std::string> names;
            for (const AxisValue& v : axis->values) names.push_back(v.name);
            return input_error("axis '" + name + "' has no value '" + value + "'" + suggestion(value, names));
        }
        auto& slot = selection[static_cast<size_t>(axis - axes.begin())];
        if (slot && *slot != *digit) return input_error("axis '" + name + "' is given twice");
        slot = digit;
    }
    return selection;
}

std::string selection_text(const std::vector<Axis>& axes, const Selection& selection) {
    std::string out;
    for (size_t a = 0; a < selection.size(); ++a)
        if (selection[a]) out += (out.empty() ? "" : " ") + axes[a].name + "=" + axes[a].values[*selection[a]].name;
    return out.empty() ? "every variant" : out;
}

Set set_of(Diagram& diagram, const Selection& selection) {
    Set set = Diagram::all();
    for (uint32_t a = 0; a < selection.size(); ++a)
        if (selection[a]) set = diagram.both(set, diagram.where(a, *selection[a]));
    return set;
}

Result<size_t> pick_shader(const std::vector<std::string>& shaders, const std::string& name) {
    if (name.empty()) {
        if (shaders.size() == 1) return size_t{0};
        return Error{Fault::usage, "there are several shaders; choose one with --shader" + suggestion("", shaders)};
    }
    const auto found = std::find(shaders.begin(), shaders.end(), name);
    if (found == shaders.end()) return input_error("no shader '" + name + "'" + suggestion(name, shaders));
    return static_cast<size_t>(found - shaders.begin());
}

}  // namespace kiln
