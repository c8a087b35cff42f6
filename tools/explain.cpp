// kiln explain: why a variant is or is not there, which text it compiles and who shares it. On a manifest it asks the space and
// the classes; on a table it asks the table (tools/explain_table.cpp).
#include "compiler/space/describe.h"
#include "tools/console.h"
#include "tools/explain_table.h"
#include "tools/json.h"
#include "tools/select.h"
#include "tools/session.h"
#include "tools/table_file.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

struct Because {
    std::string kind;  // "rule", "rules", "scene"
    Place place;
    std::string text;
};

struct StageAnswer {
    Stage stage;
    size_t classes = 0;               // of this stage
    std::vector<std::string> shares;  // one line a class that the selection reaches
    std::vector<size_t> numbers;
};

struct Answer {
    std::string shader, variant, status;  // status: "needed", "not needed", "forbidden", "partly"
    Count selected, legal, needed;
    std::vector<Because> because;
    std::vector<StageAnswer> stages;
};

Set allowed_by(Space& space, const Rule& rule) {
    const Set holds = compile_expr(space, rule.expr);
    return rule.forbid ? space.diagram->complement(holds) : holds;
}

std::string rule_text(const Rule& rule) {
    return std::string(rule.forbid ? "forbid: " : "require: ") + rule.text +
           (rule.because.empty() ? "" : " (" + rule.because + ")");
}

// The rules that alone rule the selection out; when none does alone, those that take part of it.
void blame_rules(Space& space, Set wanted, std::vector<Because>& because) {
    for (const Rule& rule : space.rules)
        if (space.diagram->disjoint(wanted, allowed_by(space, rule))) because.push_back({"rule", rule.place, rule_text(rule)});
    if (!because.empty()) return;
    for (const Rule& rule : space.rules)
        if (!space.diagram->subset(wanted, allowed_by(space, rule))) because.push_back({"rules", rule.place, rule_text(rule)});
}

Answer answer_of(Build& build, Space& space, const Selection& selection) {
    Diagram& diagram = *space.diagram;
    const Set wanted = set_of(diagram, selection);
    const Set legal = diagram.both(wanted, space.legal);
    const Set needed = diagram.both(wanted, space.needed);
    Answer answer;
    answer.shader = space.shader;
    answer.variant = selection_text(space.axes, selection);
    answer.selected = diagram.count(wanted);
    answer.legal = diagram.count(legal);
    answer.needed = diagram.count(needed);
    if (legal == Diagram::none()) {
        answer.status = "forbidden";
        blame_rules(space, wanted, answer.because);
        return answer;
    }
    if (needed == Diagram::none()) {
        answer.status = "not needed";
        for (const Scene& scene : build.scenes) {
            SceneReason reason = explain_scene(scene, space, legal);
            answer.because.push_back({"scene", std::move(reason.place), std::move(reason.text)});
        }
        return answer;
    }
    answer.status = needed == wanted ? "needed" : "partly";
    for (const StageClasses& s : build.stages) {
        if (s.space != &space) continue;
        StageAnswer stage;
        stage.stage = s.stage;
        stage.classes = s.split->classes.size();
        for (size_t c = 0; c < s.split->classes.size(); ++c) {
            const Set variants = s.split->classes[c].variants;
            if (diagram.disjoint(variants, wanted)) continue;
            stage.numbers.push_back(c);
            stage.shares.push_back(describe_condition(space, variants, space.needed));
        }
        answer.stages.push_back(std::move(stage));
    }
    return answer;
}

std::string as_text(const Answer& answer) {
    std::string out =
        answer.shader + " " + answer.variant + ": " + (answer.status == "partly" ? "needed in part" : answer.status);
    if (!(answer.selected == Count(1)))
        out += " (" + answer.selected.grouped() + " combinations, " + answer.legal.grouped() + " legal, " +
               answer.needed.grouped() + " needed)";
    out += "\n";
    for (const Because& b : answer.because) {
        out += "  ";
        if (b.place.line != 0)
            out += b.place.file + ":" + std::to_string(b.place.line) + ":" + std::to_string(b.place.column) + ": ";
        out += b.text + "\n";
    }
    for (const StageAnswer& stage : answer.stages) {
        for (size_t i = 0; i < stage.shares.size() && i < 8; ++i)
            out += std::string("  ") + name_of(stage.stage) + ": class " + std::to_string(stage.numbers[i]) + " of " +
                   std::to_string(stage.classes) + ", shared " + stage.shares[i] + "\n";
        if (stage.shares.size() > 8)
            out +=
                std::string("  ") + name_of(stage.stage) + ": and " + std::to_string(stage.shares.size() - 8) + " more classes\n";
    }
    return out;
}

std::string as_json(const Answer& answer) {
    Json json;
    json.object().text("shader", answer.shader).text("variant", answer.variant).text("status", answer.status);
    json.text("combinations", answer.selected.decimal())
        .text("legal", answer.legal.decimal())
        .text("needed", answer.needed.decimal());
    json.key("because").array();
    for (const Because& b : answer.because) {
        json.object().text("kind", b.kind).text("text", b.text).text("file", b.place.file);
        json.number("line", uint64_t{b.place.line}).number("column", uint64_t{b.place.column}).end();
    }
    json.end().key("stages").array();
    for (const StageAnswer& stage : answer.stages) {
        json.object().text("stage", name_of(stage.stage)).number("classes", uint64_t{stage.classes}).key("reached").array();
        for (size_t i = 0; i < stage.shares.size(); ++i)
            json.object().number("class", uint64_t{stage.numbers[i]}).text("shared", stage.shares[i]).end();
        json.end().end();
    }
    json.end().end();
    return json.take();
}

int run_explain(const Args& args) {
    const auto options = build_options(args);
    if (!options.ok()) return print_error(options.error());
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    if (is_table((*session)->files, options->manifest)) return explain_table(args, **session);

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
    const auto selection = parse_selection(space.axes, args.words(), 1);
    if (!selection.ok()) return print_error(selection.error());
    const Answer answer = answer_of(build, space, *selection);
    return finish(args.has("--json") ? as_json(answer) : as_text(answer));
}

}  // namespace

const Verb verb_explain{"explain",
                        "MANIFEST|T.kiln [--shader S] axis=value …",
                        "say what a variant maps to and shares with, or which rule or scene excludes it",
                        1,
                        std::string::npos,
                        {option_shader, option_scene, option_cache, option_json},
                        "kiln explain manifests/surface.yaml light=spot pass=depth",
                        run_explain};

}  // namespace kiln
