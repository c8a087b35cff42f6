// kiln dump: what is in a table, what a variant resolves to, or the texts themselves.
#include "compiler/table/table_dump.h"
#include "compiler/toolchain/spirv.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/select.h"
#include "tools/session.h"
#include "tools/table_file.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

void slot_json(Json& json, const Slot& slot) {
    json.object().text("name", slot.name);
    if (slot.kind != ResourceKind::push_constants)
        json.number("set", uint64_t{slot.set}).number("binding", uint64_t{slot.binding});
    json.number("buffer", uint64_t{slot.buffer}).number("texture", uint64_t{slot.texture});
    json.number("sampler", uint64_t{slot.sampler}).number("image", uint64_t{slot.image}).end();
}

std::string as_json(const TableDump& dump) {
    Json json;
    json.object()
        .text("name", dump.name)
        .text("tools", dump.tools)
        .number("bytes", dump.bytes)
        .number("modules", uint64_t{dump.modules});
    json.number("spirv_bytes", dump.spirv_bytes).number("text_bytes", dump.text_bytes).number("packed_bytes", dump.packed_bytes);
    json.key("scenes").array();
    for (const std::string& scene : dump.scenes) json.text(scene);
    json.end().key("artifacts").object();
    for (const auto& [target, n] : dump.artifacts) json.number(name_of(target), uint64_t{n});
    json.end().key("holes").object();
    for (const auto& [target, n] : dump.holes) json.number(name_of(target), uint64_t{n});
    json.end().key("shaders").array();
    for (const DumpShader& s : dump.shaders) {
        json.object().text("name", s.name).text("declared", s.declared.decimal()).text("legal", s.legal.decimal());
        json.text("needed", s.needed.decimal()).number("pipelines", uint64_t{s.pipelines}).key("axes").array();
        for (const DumpAxis& axis : s.axes) {
            json.object().text("name", axis.name).text("macro", axis.macro).key("values").array();
            for (const DumpValue& v : axis.values) json.object().text("name", v.name).text("needed", v.needed.decimal()).end();
            json.end().end();
        }
        json.end().key("stages").array();
        for (const DumpStage& stage : s.stages) {
            json.object().text("stage", name_of(stage.stage)).number("modules", uint64_t{stage.modules});
            json.number("spirv_bytes", stage.spirv_bytes).key("axes").array();
            for (const std::string& axis : stage.axes) json.text(axis);
            json.end().end();
        }
        json.end().key("slots").array();
        for (const Slot& slot : s.slots.slots) slot_json(json, slot);
        json.end().key("rules").array();
        for (const std::string& rule : s.rules) json.text(rule);
        json.end().end();
    }
    json.end().end();
    return json.take();
}

std::string as_json(const VariantDump& dump) {
    Json json;
    json.object().text("shader", dump.shader).text("selected", dump.selected.decimal()).text("legal", dump.legal.decimal());
    json.text("needed", dump.needed.decimal()).key("stages").array();
    for (const auto& [stage, modules] : dump.stages) {
        json.object().text("stage", name_of(stage)).key("modules").array();
        for (const DumpModule& m : modules) {
            json.object()
                .number("module", uint64_t{m.module})
                .text("digest", m.digest)
                .number("bytes", m.bytes)
                .text("shared", m.shared);
            json.key("uses").array();
            for (const Slot& slot : m.uses) slot_json(json, slot);
            json.end().key("texts").array();
            for (const TableText& text : m.texts) {
                json.object().text("target", name_of(text.target)).number("bytes", uint64_t{text.size});
                if (!text.refusal.empty()) json.text("refusal", text.refusal);
                json.end();
            }
            json.end().end();
        }
        json.end().end();
    }
    json.end().end();
    return json.take();
}

// The disassembly of each stage's only module in the selection.
Result<std::vector<DumpedText>> disassemblies(TableView& table, TableShader& shader, Set selected) {
    std::vector<DumpedText> out;
    for (const auto& [stage, modules] : dump_variants(table, shader, selected).stages) {
        if (modules.size() != 1)
            return input_error(std::string("these values leave stage ") + name_of(stage) + " several modules; say more");
        auto text = spirv_disassemble(table.module(modules[0].module).words);
        KILN_TRY(text);
        out.push_back({stage, modules[0].module, std::move(*text), {}});
    }
    if (out.empty()) return input_error("nothing selected is needed; ask kiln explain why");
    return out;
}

int print_texts(const Args& args, TableView& table, TableShader& shader, Set selected) {
    const auto target = target_named(args.value("--target"));
    if (!target) return print_error(input_error("no target '" + args.value("--target") + "'"));
    const auto texts =
        *target == Target::spirv ? disassemblies(table, shader, selected) : dump_texts(table, shader, selected, *target);
    if (!texts.ok()) return print_error(texts.error());
    std::string out;
    Json json;
    json.array();
    for (const DumpedText& text : *texts) {
        if (args.has("--stage") && args.value("--stage") != name_of(text.stage)) continue;
        json.object().text("stage", name_of(text.stage)).number("module", uint64_t{text.module});
        json.text("text", text.text).text("refusal", text.refusal).end();
        if (!args.has("--stage"))
            out += std::string("// ---- ") + name_of(text.stage) + ", module " + std::to_string(text.module) + "\n";
        out += text.refusal.empty() ? text.text : "// not in this target: " + text.refusal + "\n";
        if (!out.empty() && out.back() != '\n') out += '\n';
    }
    json.end();
    return finish(args.has("--json") ? json.take() : out);
}

int run_dump(const Args& args) {
    DiskFiles files;
    auto table = open_table(files, args.words().front());
    if (!table.ok()) return print_error(table.error());
    const bool whole = args.words().size() == 1 && !args.has("--target") && !args.has("--shader");
    if (whole) {
        const TableDump dump = dump_table(**table);
        return finish(args.has("--json") ? as_json(dump) : render(dump));
    }
    std::vector<std::string> names;
    for (const TableShader& s : (*table)->shaders()) names.push_back(s.space.shader);
    const auto picked = pick_shader(names, args.value("--shader"));
    if (!picked.ok()) return print_error(picked.error());
    TableShader& shader = (*table)->shaders()[*picked];
    const auto selection = parse_selection(shader.space.axes, args.words(), 1);
    if (!selection.ok()) return print_error(selection.error());
    const Set selected = set_of(*shader.space.diagram, *selection);
    if (args.has("--target")) return print_texts(args, **table, shader, selected);
    const VariantDump dump = dump_variants(**table, shader, selected);
    return finish(args.has("--json") ? as_json(dump) : render(dump));
}

}  // namespace

const Verb verb_dump{
    "dump",
    "T.kiln [--shader S] [axis=value …] [--target T]",
    "show a table, what variants resolve to, or their texts (--target spirv: disassembled)",
    1,
    std::string::npos,
    {option_shader,
     {"--target", nullptr, "NAME", "print the stages' texts in this target"},
     {"--stage", nullptr, "NAME", "with --target: this stage alone"},
     option_json},
    "kiln dump surface.kiln light=point pass=forward material=pbr_mr lightmap=flat two_sided=false shadow=none --target msl21",
    run_dump};

}  // namespace kiln
