#include "compiler/device/sheet_pick.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace kiln {

std::vector<size_t> pick_pipelines(const TableShader& shader, size_t count) {
    constexpr size_t most = 4096;  // candidates; what lies further on looks like what came before
    const size_t candidates = std::min(shader.pipelines.size(), most);
    std::map<std::tuple<size_t, uint32_t, size_t, uint32_t>, double> used;
    std::vector<bool> taken(candidates, false);
    std::vector<size_t> out;
    while (out.size() < std::min(count, candidates)) {
        size_t best = candidates;
        double best_gain = -1;
        for (size_t i = 0; i < candidates; ++i) {
            if (taken[i]) continue;
            const Digits& d = shader.pipelines[i].witness;
            double gain = 0;
            for (size_t a = 0; a < d.size(); ++a)
                for (size_t b = a; b < d.size(); ++b) {
                    const auto found = used.find({a, d[a], b, d[b]});
                    const double times = found == used.end() ? 0 : found->second;
                    gain += 1.0 / (1 + times);
                }
            if (gain > best_gain) best_gain = gain, best = i;
        }
        taken[best] = true;
        out.push_back(best);
        const Digits& d = shader.pipelines[best].witness;
        for (size_t a = 0; a < d.size(); ++a)
            for (size_t b = a; b < d.size(); ++b) used[{a, d[a], b, d[b]}] += 1;
    }
    std::sort(out.begin(), out.end(),
              [&](size_t a, size_t b) { return shader.pipelines[a].witness < shader.pipelines[b].witness; });
    return out;
}

Result<Digits> parse_variant(TableShader& shader, const std::string& text) {
    Space& space = shader.space;
    Set set = space.needed;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        begin = end + 1;
        if (word.empty()) continue;
        const size_t equal = word.find('=');
        if (equal == std::string::npos) return input_error("'" + word + "' is not axis=value");
        const std::string name = word.substr(0, equal), value = word.substr(equal + 1);
        bool known = false, fits = false;
        std::vector<std::string> axis_names, value_names;
        for (uint32_t a = 0; a < space.axes.size(); ++a) {
            axis_names.push_back(space.axes[a].name);
            if (space.axes[a].name != name) continue;
            known = true;
            for (uint32_t d = 0; d < space.axes[a].values.size(); ++d) {
                value_names.push_back(space.axes[a].values[d].name);
                if (space.axes[a].values[d].name != value) continue;
                fits = true;
                set = space.diagram->both(set, space.diagram->where(a, d));
            }
        }
        const std::string near = nearest(known ? value : name, known ? value_names : axis_names);
        const std::string hint = near.empty() ? "" : " (did you mean '" + near + "'?)";
        if (!known) return input_error("shader " + space.shader + " has no axis '" + name + "'" + hint);
        if (!fits) return input_error("axis " + name + " has no value '" + value + "'" + hint);
    }
    const std::optional<Digits> first = space.diagram->witness(set);
    if (!first) return input_error("no variant of " + space.shader + " in this table has " + text);
    return *first;
}

size_t pipeline_of(TableShader& shader, const Digits& variant) {
    for (size_t i = 0; i < shader.pipelines.size(); ++i) {
        bool same = true;
        for (size_t s = 0; same && s < shader.stages.size(); ++s)
            same = shader.space.diagram->contains(shader.variants_of(s, shader.pipelines[i].modules[s]), variant);
        if (same) return i;
    }
    return ~size_t{0};
}

std::string short_label(const Space& space, const Digits& variant) {
    std::string out;
    const auto say = [&](const std::string& word) { out += (out.empty() ? "" : " ") + word; };
    for (size_t a = 0; a < space.axes.size() && a < variant.size(); ++a) {
        const Axis& axis = space.axes[a];
        const std::string& value = axis.values[variant[a]].name;
        if (axis.kind == AxisKind::integer)
            say(axis.name + "=" + value);
        else if (axis.kind == AxisKind::boolean || axis.kind == AxisKind::defined) {
            if (variant[a] != 0 && value != "false") say(axis.name);
        } else if (value != "none" && value != "off") {
            say(value);
        }
    }
    return out.empty() ? "-" : out;
}

}  // namespace kiln
