// kiln count: what the axes cost, without enumerating anything.
#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

struct StageCount {
    Stage stage;
    size_t classes;
};

std::vector<StageCount> stage_counts(const Build& build, const Space* space) {
    std::vector<StageCount> out;
    for (const StageClasses& s : build.stages)
        if (s.space == space) out.push_back({s.stage, s.split->classes.size()});
    return out;
}

std::string as_json(Build& build, bool classes) {
    Json json;
    json.object().key("shaders").array();
    for (const auto& space : build.spaces) {
        Diagram& diagram = *space->diagram;
        json.object().text("name", space->shader).text("declared", space->declared().decimal());
        json.text("legal", diagram.count(space->legal).decimal()).text("needed", diagram.count(space->needed).decimal());
        json.key("axes").array();
        for (uint32_t a = 0; a < space->axes.size(); ++a) {
            json.object().text("name", space->axes[a].name).key("values").array();
            const std::vector<Count> legal = diagram.count_by_digit(space->legal, a);
            for (size_t d = 0; d < legal.size(); ++d)
                json.object().text("name", space->axes[a].values[d].name).text("legal", legal[d].decimal()).end();
            json.end().end();
        }
        json.end().key("stages").array();
        if (classes)
            for (const StageCount& s : stage_counts(build, space.get()))
                json.object().text("stage", name_of(s.stage)).text("classes", std::to_string(s.classes)).end();
        json.end().end();
    }
    json.end().key("total").object();
    json.text("declared", build.counts.declared.decimal()).text("legal", build.counts.legal.decimal());
    json.text("needed", build.counts.needed.decimal());
    if (classes) json.text("classes", std::to_string(build.counts.classes));
    json.end().end();
    return json.take();
}

std::string as_text(Build& build, bool classes) {
    std::string out;
    for (const auto& space : build.spaces) {
        Diagram& diagram = *space->diagram;
        out += space->shader + ": " + space->declared().grouped() + " declared, " + diagram.count(space->legal).grouped() +
               " legal, " + diagram.count(space->needed).grouped() + " needed\n";
        for (uint32_t a = 0; a < space->axes.size(); ++a) {
            const Axis& axis = space->axes[a];
            out += "  " + axis.name + " (" + axis.macro + "):";
            const std::vector<Count> legal = diagram.count_by_digit(space->legal, a);
            for (size_t d = 0; d < legal.size() && d < 16; ++d) out += " " + axis.values[d].name + " " + legal[d].grouped();
            if (legal.size() > 16) out += " … " + std::to_string(legal.size() - 16) + " more values";
            out += "\n";
        }
        if (classes)
            for (const StageCount& s : stage_counts(build, space.get()))
                out += std::string("  ") + name_of(s.stage) + ": " + Count(s.classes).grouped() + " classes\n";
    }
    out += "total: " + build.counts.declared.grouped() + " declared, " + build.counts.legal.grouped() + " legal, " +
           build.counts.needed.grouped() + " needed";
    if (classes) out += ", " + Count(build.counts.classes).grouped() + " classes";
    return out + "\n";
}

// Up to `most` needed variants, one a line: the shader, then axis=value words.
std::string as_list(Build& build, uint64_t most) {
    std::string out;
    for (const auto& space : build.spaces)
        space->diagram->enumerate(space->needed, [&](const Digits& digits) {
            if (most == 0) return false;
            --most;
            out += space->shader + " " + space->describe_variant(digits) + "\n";
            return true;
        });
    return out;
}

int run_count(const Args& args) {
    const auto options = build_options(args);
    if (!options.ok()) return print_error(options.error());
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    const bool classes = args.has("--classes");
    Build build;
    pass_spaces(build, *options, *(*session)->context);
    const auto list = args.number("--list", 0, 1, 1'000'000'000);
    if (!list.ok()) return print_error(list.error());
    if (classes && build.ok()) pass_classes(build, *options, *(*session)->context);
    build.diags.sort();
    if (const int code = report_build(build); code != 0) return code;
    if (*list != 0 && !args.has("--json")) return finish(as_list(build, *list));
    return finish(args.has("--json") ? as_json(build, classes) : as_text(build, classes));
}

}  // namespace

const Verb verb_count{"count",
                      "MANIFEST [--scene S]… [--classes] [--json]",
                      "count variants exactly, per axis value; with --classes also the distinct token streams",
                      1,
                      1,
                      {option_scene,
                       {"--classes", nullptr, nullptr, "preprocess, and count classes per stage"},
                       {"--list", nullptr, "N", "print up to N needed variants instead, one a line"},
                       option_json,
                       option_cache},
                      "kiln count manifests/surface.yaml --classes",
                      run_count};

}  // namespace kiln
