// Puts the parts together: sources, predefined macros and axes, one walk (preprocess.h), then the distinct texts as classes
// and the mistakes with the condition under which each happens.
#include "compiler/split/split.h"

#include <algorithm>
#include <cassert>

#include "compiler/base/jobs.h"
#include "compiler/space/describe.h"
#include "compiler/split/class_text.h"
#include "compiler/split/predefined.h"
#include "compiler/split/preprocess.h"

namespace kiln {

namespace {

struct Version {
    int number = 110;  // what glslang takes a shader without #version for
    bool es = false;
    bool compatibility = false;
    std::string line;  // as written, or empty
    TextPlace place;
};

// #version decides what is predefined, so it is looked for before anything is read.
Version find_version(const LexedFile& file, const Spellings& spellings, uint16_t index, Findings& findings, Set start) {
    Version out;
    out.place = {index, 1, 1};
    bool first = true;
    for (const Item& item : file.items) {
        if (item.kind != Directive::version) {
            first = first && item.kind != Directive::text;
            continue;
        }
        Token at;
        at.file = index;
        at.line = item.line;
        at.column = item.column;
        out.place = {index, item.line, item.column};
        if (!first || item.depth != 0) findings.error(at, "#version must come first and outside of conditionals", start);
        const Token* const t = file.tokens.data() + item.begin;
        const size_t count = item.end - item.begin;
        if (count == 0 || t[0].kind != Tok::integer) {
            findings.error(at, "#version must be followed by a version number", start);
            return out;
        }
        const std::string number(spellings.text(t[0].text));
        out.number = number.size() > 4 ? 9999 : std::stoi(number);
        const std::string profile = count > 1 ? std::string(spellings.text(t[1].text)) : std::string();
        if (count > 1 && profile != "es" && profile != "core" && profile != "compatibility")
            findings.error(t[1], "bad profile name; use es, core, or compatibility", start);
        if (count > 2) findings.error(t[2], "unexpected tokens following #version", start);
        out.es = profile == "es" ||
                 (profile.empty() && (out.number == 100 || out.number == 300 || out.number == 310 || out.number == 320));
        out.compatibility = profile == "compatibility";
        out.line = "#version " + number + (profile.empty() ? "" : " " + profile);
        return out;
    }
    return out;
}

void report(const Findings& findings, const Sources& sources, Space& space, Set start, Diags& diags) {
    for (const Finding& f : findings.list()) {
        const SourceFile& file = sources.file(f.file);
        Diag& diag = diags.add(f.severity, {file.path, f.line, f.column}, f.message, std::string(line_of(file.content, f.line)));
        diag.notes.push_back(describe_condition(space, f.set, start));
        if (f.forbid) {
            const std::string words = describe_set(space, f.set, start);
            diag.notes.push_back(words.empty() || words == "always"
                                     ? "a `forbid:` rule in the manifest keeps variants away from here"
                                     : "to leave these out, add the rule `- forbid: " + words + "`");
        }
        for (const std::string& note : f.notes) diag.notes.push_back(note);
    }
    diags.sort();
}

// "light (120), pass (30)": the axes that the split-off sets depend on, most first.
std::string busiest_axes(const Space& space, const std::vector<Set>& sets, Set start) {
    const std::vector<uint32_t> always = space.diagram->support(start);
    std::vector<std::pair<uint64_t, uint32_t>> tally(space.axes.size());
    for (uint32_t a = 0; a < tally.size(); ++a) tally[a] = {0, a};
    const size_t stride = std::max<size_t>(1, sets.size() / 2000);
    for (size_t i = 0; i < sets.size(); i += stride)
        for (const uint32_t axis : space.diagram->support(sets[i]))
            if (sets.size() < 50 || std::find(always.begin(), always.end(), axis) == always.end() ||
                always.size() == space.axes.size())
                ++tally[axis].first;
    std::stable_sort(tally.begin(), tally.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string out;
    for (size_t i = 0; i < tally.size() && i < 5 && tally[i].first != 0; ++i)
        out += (i == 0 ? "" : ", ") + space.axes[tally[i].second].name;
    return out;
}

}  // namespace

bool partition(const std::vector<Class>& classes, Diagram& diagram, Set whole) {
    Set seen = Diagram::none();
    for (const Class& c : classes) {
        if (c.variants == Diagram::none() || !diagram.disjoint(seen, c.variants)) return false;
        seen = diagram.either(seen, c.variants);
    }
    return seen == whole && !diagram.exhausted();
}

Split split_stage(const Manifest& manifest, const Shader& shader, const StageFile& stage, Space& space, Set start, Files& files,
                  const SplitOptions& options) {
    Split out;
    if (start == Diagram::none()) return out;
    Spellings spellings;
    Sources sources(manifest, files, spellings);
    Diagram& diagram = *space.diagram;
    Findings findings(diagram);
    const Found root = sources.find(stage.file, std::nullopt);
    if (!root.file) {
        out.diags.error(stage.place, root.problem);
        out.reads = sources.reads();
        return out;
    }
    const Version version = find_version(sources.file(*root.file).lexed, spellings, *root.file, findings, start);
    Macros macros(diagram, start);
    Preprocessing pp{space, diagram, spellings, macros, findings, version.number, version.es, {}, {}, {}, 0};
    pp.axes_read.assign(space.axes.size(), false);
    Emitted emitted(diagram, options.lines);
    emitted.limit_groups(static_cast<size_t>(std::min<uint64_t>(options.max_states, 1u << 30)));
    Preprocessor preprocessor(pp, sources, emitted, shader.options, options.max_states);
    for (const Predefined& p : predefined_macros(stage.stage, version.number, version.es, version.compatibility))
        preprocessor.predefine(p.name, p.value == 1 ? "1" : std::to_string(p.value), start);
    for (const auto& [name, body] : shader.defines) preprocessor.predefine(name, body, start);
    for (uint32_t axis = 0; axis < space.axes.size(); ++axis) preprocessor.predefine_axis(axis, start);
    preprocessor.run(*root.file, start);
    if (interrupted.load()) return out;

    std::vector<Emitted::Group> groups;
    bool over = preprocessor.over_limit();
    std::vector<Set> excess = preprocessor.split_sets();
    if (!over) {
        groups =
            emitted.refine(preprocessor.text(), start, static_cast<size_t>(std::min<uint64_t>(options.max_states, 1u << 30)));
        over = groups.size() > options.max_states;
    }
    out.states = preprocessor.states();
    if (over) {
        for (const Emitted::Group& g : emitted.excess()) excess.push_back(g.set);
        for (const Emitted::Group& g : groups) excess.push_back(g.set);
        const std::string axes = busiest_axes(space, excess, start);
        out.diags.error(stage.place, stage.file + " has more than " + std::to_string(options.max_states) +
                                         " different texts or preprocessor states" +
                                         (axes.empty() ? std::string() : "; the axes that split most: " + axes));
        groups.clear();
    }
    if (diagram.exhausted()) {
        const std::string axes = busiest_axes(space, excess, start);
        out.diags.error(stage.place, "the conditions in " + stage.file + " make sets of variants too large to hold" +
                                         (axes.empty() ? std::string() : "; the axes that split most: " + axes));
        return out;
    }
    for (size_t i = 0; i < sources.count(); ++i) out.files.push_back(sources.file(static_cast<uint16_t>(i)).name);
    out.reads = sources.reads();
    out.lexed = sources.count();
    for (uint32_t axis = 0; axis < pp.axes_read.size(); ++axis)
        if (pp.axes_read[axis]) out.axes_read.push_back(axis);
    report(findings, sources, space, start, out.diags);

    std::vector<std::pair<Digits, size_t>> order;
    for (size_t i = 0; i < groups.size(); ++i) order.emplace_back(*diagram.witness(groups[i].set), i);
    std::sort(order.begin(), order.end());
    std::vector<Token> tokens;
    for (const auto& [witness, i] : order) {
        tokens.clear();
        emitted.flatten(groups[i].rope, tokens);
        ClassText text = write_class_text(tokens, spellings, sources, version.line, version.place, options.lines,
                                          version.number >= (version.es ? 300 : 330));
        out.classes.push_back({groups[i].set, std::move(text.text), std::move(text.places)});
    }
    if (!out.classes.empty() && !partition(out.classes, diagram, start)) {
        assert(false && "classes do not partition the variants");
        out.diags.error(stage.place, "internal error: the classes of " + stage.file + " do not partition its variants");
        out.classes.clear();
    }
    return out;
}

}  // namespace kiln
