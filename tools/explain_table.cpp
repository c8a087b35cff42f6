#include "tools/explain_table.h"

#include "compiler/space/describe.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/select.h"
#include "tools/table_file.h"

namespace kiln {

namespace {

struct StageModules {
    Stage stage;
    size_t modules = 0;  // of this stage
    std::vector<std::pair<uint32_t, std::string>> reached;
};

std::string status_of(TableShader& shader, Set wanted) {
    Diagram& diagram = *shader.space.diagram;
    if (diagram.disjoint(wanted, shader.space.legal)) return "forbidden";
    if (diagram.disjoint(wanted, shader.space.needed)) return "not needed";
    return diagram.subset(wanted, shader.space.needed) ? "needed" : "partly";
}

std::vector<std::string> reasons(const TableView& table, TableShader& shader, Set wanted, const std::string& status) {
    std::vector<std::string> out;
    Diagram& diagram = *shader.space.diagram;
    const auto say = [](const TableRule& rule) {
        return std::string(rule.forbid ? "forbid: " : "require: ") + rule.text +
               (rule.because.empty() ? "" : " (" + rule.because + ")");
    };
    if (status == "forbidden") {
        for (const TableRule& rule : shader.rules)
            if (diagram.subset(wanted, rule.broken)) out.push_back(say(rule));
        if (out.empty())
            for (const TableRule& rule : shader.rules)
                if (!diagram.disjoint(wanted, rule.broken)) out.push_back(say(rule));
    } else if (status == "not needed") {
        for (const std::string& scene : table.scenes()) out.push_back("not needed by " + scene);
    }
    return out;
}

}  // namespace

int explain_table(const Args& args, Session& session) {
    if (args.has("--scene"))
        return print_error({Fault::usage, "kiln explain: a table has its scenes built in; --scene goes with a manifest"});
    auto table = open_table(session.files, args.words().front());
    if (!table.ok()) return print_error(table.error());
    std::vector<std::string> names;
    for (const TableShader& s : (*table)->shaders()) names.push_back(s.space.shader);
    const auto picked = pick_shader(names, args.value("--shader"));
    if (!picked.ok()) return print_error(picked.error());
    TableShader& shader = (*table)->shaders()[*picked];
    const auto selection = parse_selection(shader.space.axes, args.words(), 1);
    if (!selection.ok()) return print_error(selection.error());

    Diagram& diagram = *shader.space.diagram;
    const Set wanted = set_of(diagram, *selection);
    const std::string status = status_of(shader, wanted);
    const std::vector<std::string> because = reasons(**table, shader, wanted, status);
    const std::string variant = selection_text(shader.space.axes, *selection);
    const Count needed = diagram.count(diagram.both(wanted, shader.space.needed));
    std::vector<StageModules> stages;
    for (size_t s = 0; s < shader.stages.size() && !needed.is_zero(); ++s) {
        StageModules stage{shader.stages[s].stage, shader.stages[s].modules.size(), {}};
        for (const uint32_t module : shader.stages[s].modules) {
            const Set users = shader.variants_of(s, module);
            if (!diagram.disjoint(users, wanted))
                stage.reached.emplace_back(module, describe_condition(shader.space, users, shader.space.needed));
        }
        stages.push_back(std::move(stage));
    }

    if (args.has("--json")) {
        Json json;
        json.object().text("shader", shader.space.shader).text("variant", variant).text("status", status);
        json.text("needed", needed.decimal()).key("because").array();
        for (const std::string& text : because) json.text(text);
        json.end().key("stages").array();
        for (const StageModules& stage : stages) {
            json.object().text("stage", name_of(stage.stage)).number("modules", uint64_t{stage.modules}).key("reached").array();
            for (const auto& [module, shared] : stage.reached) {
                json.object().number("module", uint64_t{module}).text("digest", (*table)->module(module).digest.hex());
                json.text("shared", shared).end();
            }
            json.end().end();
        }
        json.end().end();
        return finish(json.take());
    }
    std::string out = shader.space.shader + " " + variant + ": " +
                      (status == "partly" ? "needed in part, " + needed.grouped() + " variants" : status) + "\n";
    for (const std::string& text : because) out += "  " + text + "\n";
    for (const StageModules& stage : stages) {
        for (size_t i = 0; i < stage.reached.size() && i < 8; ++i)
            out += std::string("  ") + name_of(stage.stage) + ": module " + std::to_string(stage.reached[i].first) + " (" +
                   (*table)->module(stage.reached[i].first).digest.hex().substr(0, 12) + "), shared " + stage.reached[i].second +
                   "\n";
        if (stage.reached.size() > 8)
            out += std::string("  ") + name_of(stage.stage) + ": and " + std::to_string(stage.reached.size() - 8) +
                   " more modules\n";
    }
    return finish(out);
}

}  // namespace kiln
