#include "compiler/table/table_dump.h"

#include <algorithm>

#include "compiler/space/describe.h"

namespace kiln {

namespace {

std::string joined(const std::vector<std::string>& parts) {
    std::string out;
    for (const std::string& p : parts) out += (out.empty() ? "" : ", ") + p;
    return out;
}

DumpShader dump_shader(TableView& table, TableShader& shader) {
    DumpShader out;
    Diagram& diagram = *shader.space.diagram;
    out.name = shader.space.shader;
    out.declared = shader.space.declared();
    out.legal = diagram.count(shader.space.legal);
    out.needed = diagram.count(shader.space.needed);
    const auto counts = diagram.count_by_digits(shader.space.needed);
    for (size_t a = 0; a < shader.space.axes.size(); ++a) {
        const Axis& axis = shader.space.axes[a];
        DumpAxis to{axis.name, axis.macro, {}};
        for (size_t v = 0; v < axis.values.size(); ++v)
            to.values.push_back({axis.values[v].name, axis.values[v].number, counts[a][v]});
        out.axes.push_back(std::move(to));
    }
    for (const TableStage& stage : shader.stages) {
        DumpStage to;
        to.stage = stage.stage;
        for (const uint32_t axis : stage.axes) to.axes.push_back(shader.space.axes[axis].name);
        to.modules = stage.modules.size();
        for (const uint32_t m : stage.modules) to.spirv_bytes += table.module(m).words.size_bytes();
        out.stages.push_back(std::move(to));
    }
    for (const TableRule& rule : shader.rules)
        out.rules.push_back((rule.forbid ? "forbid: " : "require: ") + rule.text +
                            (rule.because.empty() ? "" : " (" + rule.because + ")"));
    out.slots = shader.slots;
    out.pipelines = shader.pipelines.size();
    return out;
}

std::vector<uint32_t> reached(TableShader& shader, size_t stage, Set wanted) {
    std::vector<uint32_t> out;
    for (const uint32_t m : shader.stages[stage].modules)
        if (!shader.space.diagram->disjoint(shader.variants_of(stage, m), wanted)) out.push_back(m);
    return out;
}

}  // namespace

TableDump dump_table(TableView& table) {
    TableDump out;
    out.name = table.name();
    out.tools = table.tools();
    out.scenes = table.scenes();
    out.bytes = table.bytes().size();
    out.spirv_bytes = table.info().spirv_bytes;
    out.text_bytes = table.info().text_bytes;
    out.packed_bytes = table.info().packed_bytes;
    out.modules = table.info().module_count;
    for (const Target t : table.targets()) out.artifacts[t] = t == Target::spirv ? out.modules : 0;
    for (uint32_t i = 0; i < table.info().artifact_count; ++i) {
        kiln_artifact a;
        if (kiln_get_artifact(&table.raw(), i, &a) == KILN_OK && a.target < target_count)
            ++out.artifacts[static_cast<Target>(a.target)];
    }
    for (TableShader& shader : table.shaders()) {
        out.shaders.push_back(dump_shader(table, shader));
        for (uint32_t i = 0; i < shader.raw.module_count; ++i)
            for (const TableText& text : table.texts(shader, kiln_shader_module(&shader.raw, i)))
                if (!text.artifact) ++out.holes[text.target];
    }
    return out;
}

VariantDump dump_variants(TableView& table, TableShader& shader, Set selected) {
    VariantDump out;
    Diagram& diagram = *shader.space.diagram;
    const Set wanted = diagram.both(selected, shader.space.needed);
    out.shader = shader.space.shader;
    out.selected = diagram.count(selected);
    out.legal = diagram.count(diagram.both(selected, shader.space.legal));
    out.needed = diagram.count(wanted);
    for (size_t s = 0; s < shader.stages.size(); ++s) {
        out.stages.push_back({shader.stages[s].stage, {}});
        for (const uint32_t m : reached(shader, s, wanted)) {
            const TableModule module = table.module(m);
            DumpModule to;
            to.module = m;
            to.digest = module.digest.hex();
            to.bytes = module.words.size_bytes();
            to.shared = describe_condition(shader.space, shader.variants_of(s, m), shader.space.needed);
            to.reflection = table.reflection(m);
            for (uint32_t i = 0; i < shader.slots.slots.size(); ++i)
                if (kiln_uses_slot(&shader.raw, m, i) != 0) to.uses.push_back(shader.slots.slots[i]);
            to.texts = table.texts(shader, m);
            out.stages.back().second.push_back(std::move(to));
        }
    }
    return out;
}

Result<std::vector<DumpedText>> dump_texts(TableView& table, TableShader& shader, Set selected, Target target) {
    const auto& targets = table.targets();
    if (std::find(targets.begin(), targets.end(), target) == targets.end()) {
        std::vector<std::string> names;
        for (const Target t : targets) names.push_back(name_of(t));
        return input_error(std::string("the table has no target ") + name_of(target) + ", only " + joined(names));
    }
    Diagram& diagram = *shader.space.diagram;
    const Set wanted = diagram.both(selected, shader.space.needed);
    if (wanted == Diagram::none())
        return input_error(diagram.disjoint(selected, shader.space.legal) ? "the rules forbid this variant"
                                                                          : "no scene needs this variant");
    std::vector<DumpedText> out;
    for (size_t s = 0; s < shader.stages.size(); ++s) {
        const std::vector<uint32_t> modules = reached(shader, s, wanted);
        if (modules.size() != 1) {
            std::vector<std::string> axes;
            for (const uint32_t a : shader.stages[s].axes) {
                const auto counts = diagram.count_by_digits(wanted)[a];
                if (std::count_if(counts.begin(), counts.end(), [](const Count& c) { return !c.is_zero(); }) > 1)
                    axes.push_back(shader.space.axes[a].name);
            }
            return input_error("the " + std::string(name_of(shader.stages[s].stage)) + " stage has " +
                               std::to_string(modules.size()) + " modules for this selection: say more about " + joined(axes));
        }
        DumpedText text;
        text.stage = shader.stages[s].stage;
        text.module = modules[0];
        for (const TableText& t : table.texts(shader, modules[0])) {
            if (t.target != target) continue;
            if (t.artifact)
                text.text = table.text(*t.artifact);
            else
                text.refusal = t.refusal;
        }
        out.push_back(std::move(text));
    }
    return out;
}

}  // namespace kiln
