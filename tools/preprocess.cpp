// kiln preprocess: the tokens that glslang would see for a variant, laid out by source line.
#include <algorithm>

#include "tools/console.h"
#include "tools/json.h"
#include "tools/select.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

// One source line a line, tokens apart by one space; a directive keeps a line of its own, and #line says where a jump lands:
// the line and the number of the file, 0 for the stage's own.
std::string laid_out(const Class& c) {
    std::string out;
    size_t begin = 0, index = 0;
    TextPlace last;
    bool fresh = true;
    while (begin < c.text.size()) {
        size_t end = c.text.find('\n', begin);
        if (end == std::string::npos) end = c.text.size();
        const std::string token = c.text.substr(begin, end - begin);
        const TextPlace place = index < c.places.size() ? c.places[index] : last;
        begin = end + 1;
        ++index;
        const bool directive = !token.empty() && token[0] == '#';
        if (!fresh && !directive && place.file == last.file && place.line == last.line) {
            out += ' ';
        } else {
            if (!out.empty() && out.back() != '\n') out += '\n';
            const bool version = directive && token.compare(0, 8, "#version") == 0;
            const bool jump = place.file != last.file || place.line != last.line + 1;
            if (jump && !version && token.compare(0, 5, "#line") != 0 && place.line != 0)
                out += "#line " + std::to_string(place.line) + " " + std::to_string(place.file) + "\n";
        }
        out += token;
        fresh = directive;
        last = place;
    }
    if (!out.empty() && out.back() != '\n') out += '\n';
    return out;
}

// The axes that tell the wanted variants' classes apart: those that the rules and the values given leave open, and that some
// class's condition within them still needs.
std::string axes_that_tell(Space& space, const std::vector<Class>& classes, Set wanted) {
    Diagram& diagram = *space.diagram;
    std::vector<bool> tells(space.axes.size());
    for (const Class& c : classes)
        if (!diagram.disjoint(c.variants, wanted))
            for (const uint32_t axis : diagram.support(diagram.simplify(c.variants, wanted))) tells[axis] = true;
    const std::vector<std::vector<bool>> used = diagram.digits_used(wanted);
    std::string out;
    for (size_t axis = 0; axis < tells.size(); ++axis)
        if (tells[axis] && std::count(used[axis].begin(), used[axis].end(), true) > 1)
            out += (out.empty() ? "" : ", ") + space.axes[axis].name;
    return out;
}

int run_preprocess(const Args& args) {
    const auto options = build_options(args);
    if (!options.ok()) return print_error(options.error());
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    Build build;
    pass_spaces(build, *options, *(*session)->context);
    if (build.ok()) pass_classes(build, *options, *(*session)->context);
    build.diags.sort();
    if (const int code = report_build(build); code != 0) return code;

    std::vector<std::string> shaders;
    for (const auto& space : build.spaces) shaders.push_back(space->shader);
    const auto picked = pick_shader(shaders, args.value("--shader"));
    if (!picked.ok()) return print_error(picked.error());
    Space& space = *build.spaces[*picked];

    std::vector<const StageClasses*> stages;
    std::vector<std::string> names;
    for (const StageClasses& s : build.stages)
        if (s.space == &space && (!args.has("--stage") || args.value("--stage") == name_of(s.stage))) stages.push_back(&s);
    for (const StageClasses& s : build.stages)
        if (s.space == &space) names.emplace_back(name_of(s.stage));
    if (stages.size() != 1) {
        std::string list;
        for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
        if (args.has("--stage"))
            return print_error(input_error(space.shader + " has no stage '" + args.value("--stage") + "'; it has " + list));
        return print_error({Fault::usage, space.shader + " has several stages (" + list + "); choose one with --stage"});
    }
    const Split& split = *stages.front()->split;

    const auto selection = parse_selection(space.axes, args.words(), 1);
    if (!selection.ok()) return print_error(selection.error());
    const Set wanted = space.diagram->both(set_of(*space.diagram, *selection), space.needed);
    if (wanted == Diagram::none()) return print_error(input_error("no needed variant has these values; ask kiln explain why"));
    const Class* found = nullptr;
    for (const Class& c : split.classes) {
        if (space.diagram->disjoint(c.variants, wanted)) continue;
        if (found == nullptr) {
            found = &c;
            continue;
        }
        return print_error(
            {Fault::usage, "these values leave several classes; say more of: " + axes_that_tell(space, split.classes, wanted)});
    }
    const std::string text = laid_out(*found);
    if (!args.has("--json")) return finish(text);
    Json json;
    json.object().text("shader", space.shader).text("stage", name_of(stages.front()->stage));
    json.number("class", static_cast<uint64_t>(found - split.classes.data())).number("classes", uint64_t{split.classes.size()});
    json.text("variants", space.diagram->count(found->variants).decimal()).text("text", text).end();
    return finish(json.take());
}

}  // namespace

const Verb verb_preprocess{"preprocess",
                           "MANIFEST [--shader S] [--stage T] axis=value …",
                           "print the text that one variant's stage compiles; axes that do not matter to it may be left out",
                           1,
                           std::string::npos,
                           {option_shader,
                            {"--stage", nullptr, "NAME", "which stage, where there are several"},
                            option_scene,
                            option_cache,
                            option_json},
                           "kiln preprocess manifests/surface.yaml --stage fragment light=point pass=depth",
                           run_preprocess};

}  // namespace kiln
