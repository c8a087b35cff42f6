// A mistake in a shader shows up once per class that contains it, at the same token. Grouping by place and message, and taking
// the union of the classes' sets, turns thousands of messages into one line and the exact condition under which it appears.

#include "compiler/modules/blame.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "compiler/space/describe.h"

namespace kiln {
namespace {

// The place of a text line. Past the end (a missing brace is noticed there) it is that of the last token.
Place place_of(const Split& split, size_t class_index, uint32_t line) {
    const Class& c = split.classes[class_index];
    if (line == 0 || c.places.empty()) return {split.files.empty() ? std::string() : split.files.front(), 0, 0};
    const TextPlace& at = c.places[std::min<size_t>(line, c.places.size()) - 1];
    return {at.file < split.files.size() ? split.files[at.file] : std::string(), at.line, at.column};
}

struct Group {
    Diag diag;
    std::map<std::pair<size_t, const Space*>, std::pair<Space*, Set>> sets;  // by first stage of the shader, for a stable order
};

using Key = std::tuple<std::string, uint32_t, uint32_t, Severity, std::string>;

}  // namespace

SourceLines source_lines(Files& files, std::string folder) {
    auto known = std::make_shared<std::map<std::string, std::string>>();
    return [&files, folder = std::move(folder), known](const std::string& file, uint32_t line) -> std::string {
        if (file.empty() || line == 0) return {};
        auto at = known->find(file);
        if (at == known->end()) {
            const Result<std::optional<std::string>> text = files.read(join_path(folder, file));
            at = known->emplace(file, text.ok() && text->has_value() ? **text : std::string()).first;
        }
        return std::string(line_of(at->second, line));
    };
}

Diags blame(const std::vector<StageClasses>& stages, const std::vector<ClassMessage>& messages, const SourceLines& lines,
            bool at_least, size_t limit) {
    std::map<const Space*, size_t> first_stage;
    for (size_t i = 0; i < stages.size(); ++i) first_stage.emplace(stages[i].space, i);

    std::map<Key, Group> groups;
    for (const ClassMessage& m : messages) {
        const StageClasses& stage = stages[m.stage];
        const Place place = place_of(*stage.split, m.of_class, m.message.line);
        Group& group = groups[Key{place.file, place.line, place.column, m.message.severity, m.message.text}];
        if (group.sets.empty()) {
            group.diag.severity = m.message.severity;
            group.diag.place = place;
            group.diag.message = m.message.text;
        }
        auto& set = group.sets[{first_stage[stage.space], stage.space}];
        set.first = stage.space;
        set.second = stage.space->diagram->either(set.second, stage.split->classes[m.of_class].variants);
    }

    Diags diags;
    size_t told = 0, left_out = 0;
    for (auto& [key, group] : groups) {
        if (group.diag.severity == Severity::error && told++ >= limit) {
            ++left_out;
            continue;
        }
        Diag& diag = diags.add(group.diag.severity, group.diag.place, group.diag.message);
        if (lines) diag.source_line = lines(diag.place.file, diag.place.line);
        for (const auto& [order, set] : group.sets) {
            diag.notes.push_back(describe_condition(*set.first, set.second, set.first->needed, at_least));
        }
    }
    if (left_out != 0) diags.error({}, std::to_string(left_out) + " more errors are not shown");
    diags.sort();
    return diags;
}

}  // namespace kiln
