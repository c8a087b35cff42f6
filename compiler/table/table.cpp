// Numbers of shaders, modules and artifacts in the table are those of the input, so that the proof, the report and the table
// speak of the same things. A stage's diagram gives places in its shader's own list of modules: lists are short, and one
// list serves artifacts and used slots alike.

#include "compiler/table/table.h"

#include <algorithm>
#include <set>

#include "compiler/table/key_layout.h"
#include "compiler/table/proof.h"
#include "compiler/table/table_nodes.h"
#include "compiler/table/table_reflect.h"
#include "compiler/table/table_text.h"

namespace kiln {

namespace {

class TableWriter {
public:
    TableWriter(const TableInput& input, const Jobs& jobs) : in_(input), jobs_(jobs) {}

    Result<Bytes> write() {
        info();
        KILN_TRY(texts());
        modules();
        const auto shaders = stages_by_shader(in_.stages);
        for (uint32_t i = 0; i < shaders.size(); ++i) KILN_TRY(shader(i, *in_.stages[shaders[i][0]].space, shaders[i]));
        auto next = static_cast<uint32_t>(shaders.size());
        for (Space* space : in_.left_out) KILN_TRY(shader(next++, *space, {}));
        return out_.file();
    }

private:
    void info() {
        kf_info_record r{};
        r.name = out_.text(in_.manifest->name);
        r.tools = out_.text(in_.tool_versions);
        r.vulkan = in_.manifest->options.vulkan;
        r.spirv = in_.manifest->options.spirv;
        std::vector<uint32_t> targets;
        for (const Target t : in_.targets) targets.push_back(static_cast<uint32_t>(t));
        r.targets = out_.append(kf_numbers, targets);
        std::vector<kf_text> scenes;
        for (const std::string& s : in_.scenes) scenes.push_back(out_.text(s));
        r.scenes = out_.append(kf_texts, scenes);
        out_.append(kf_info, std::vector<kf_info_record>{r});
    }

    // Records keep the artifacts' order; blocks go by target and stage, in the order of first use within them.
    Status texts() {
        const auto& list = in_.artifacts->list;
        std::vector<std::pair<uint32_t, uint32_t>> kind(list.size());
        for (size_t i = 0; i < list.size(); ++i) kind[i].first = static_cast<uint32_t>(list[i].target);
        for (const auto& by_target : in_.artifacts->of)
            for (const auto& by_module : by_target)
                for (size_t m = 0; m < by_module.size(); ++m)
                    if (by_module[m] < list.size()) kind[by_module[m]].second = static_cast<uint32_t>(in_.modules->list[m].stage);
        std::vector<size_t> order(list.size());
        for (size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return kind[a] < kind[b]; });
        std::vector<const std::string*> texts;
        std::vector<bool> breaks;
        for (size_t i = 0; i < order.size(); ++i) {
            texts.push_back(&list[order[i]].text);
            breaks.push_back(i != 0 && kind[order[i]] != kind[order[i - 1]]);
        }
        Result<PackedTexts> packed = pack_texts(texts, breaks, jobs_);
        KILN_TRY(packed);
        std::vector<kf_artifact_record> records(list.size());
        for (size_t i = 0; i < order.size(); ++i) {
            records[order[i]] = packed->places[i];
            records[order[i]].target = kind[order[i]].first;
        }
        out_.append(kf_artifacts, records);
        out_.append(kf_blocks, packed->blocks);
        out_.append(kf_packed, packed->bytes);
        return {};
    }

    void modules() {
        std::vector<kf_module_record> records;
        for (const Module& m : in_.modules->list) {
            kf_module_record r{};
            r.stage = static_cast<uint32_t>(m.stage);
            r.reflection = write_reflection(out_, m.reflection);
            const kf_range words = out_.append(kf_spirv, m.words);
            r.at = words.first;
            r.words = words.count;
            std::copy(m.digest.bytes.begin(), m.digest.bytes.end(), r.digest);
            records.push_back(r);
        }
        out_.append(kf_modules, records);
    }

    uint32_t diagram(const LeafMaps& maps, LeafMaps::Ref map, const std::vector<uint32_t>& fields, uint32_t leaves,
                     std::vector<uint32_t>* axes = nullptr) {
        NodeWords nodes = write_nodes(maps, map, fields, leaves);
        const kf_range at = out_.list(kf_nodes, nodes.words);
        if (axes != nullptr) *axes = std::move(nodes.axes);
        return out_.one(kf_diagrams, kf_diagram_record{at.first, at.count, nodes.root, leaves});
    }

    Status shader(uint32_t index, Space& space, const std::vector<size_t>& stages) {
        const KeyLayout layout = key_layout(space.axes);
        std::vector<uint32_t> fields;
        for (const KeyField& f : layout.fields) fields.push_back(f.packed());
        kf_shader_record r{};
        r.name = out_.text(space.shader);
        r.declared = out_.text(space.declared().decimal());
        r.legal = out_.text(space.diagram->count(space.legal).decimal());
        r.needed = out_.text(space.diagram->count(space.needed).decimal());
        axes(r, space, layout);
        r.order = out_.append(kf_numbers, space.diagram->order());

        LeafMaps maps(*space.diagram);
        const auto status = maps.merge_all({maps.from_set(space.needed, kf_leaf_needed),
                                            maps.from_set(space.diagram->minus(space.legal, space.needed), kf_leaf_not_needed),
                                            maps.from_set(space.diagram->complement(space.legal), kf_leaf_forbidden)});
        r.status = diagram(maps, *status, fields, 3);

        std::vector<uint32_t> used;
        for (const size_t s : stages) used.insert(used.end(), in_.modules->of_class[s].begin(), in_.modules->of_class[s].end());
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        r.modules = out_.append(kf_numbers, used);
        std::vector<kf_stage_record> records;
        for (const size_t s : stages) {
            kf_stage_record stage{};
            KILN_TRY(this->stage(stage, s, used, maps, fields));
            records.push_back(stage);
        }
        r.stages = out_.append(kf_stages, records);
        rules(r, space, fields);
        artifacts(r, index, used);
        slots(r, index, used);
        pipelines(r, index, layout);
        out_.append(kf_shaders, std::vector<kf_shader_record>{r});
        return {};
    }

    void axes(kf_shader_record& r, const Space& space, const KeyLayout& layout) {
        std::vector<kf_axis_record> records;
        std::vector<kf_check_record> checks;
        for (const uint64_t mask : layout.masks) checks.push_back({mask, 0, 0});
        for (uint32_t i = 0; i < space.axes.size(); ++i) {
            const Axis& axis = space.axes[i];
            std::vector<kf_value_record> values;
            for (const AxisValue& v : axis.values) values.push_back({out_.text(v.name), v.number, 0});
            const uint32_t field = layout.fields[i].packed(), radix = static_cast<uint32_t>(axis.values.size());
            records.push_back({out_.text(axis.name), out_.text(axis.macro), out_.list(kf_values, values),
                               static_cast<uint32_t>(axis.kind), field});
            const KeyField& f = layout.fields[i];
            if (const uint64_t lacks = (uint64_t{1} << f.bits) - radix; lacks != 0) {
                checks[f.word].addend |= lacks << f.shift;
                if (f.shift + f.bits < 64) checks[f.word].carry |= uint64_t{1} << (f.shift + f.bits);
            }
        }
        r.axes = out_.append(kf_axes, records);
        r.checks = out_.append(kf_checks, checks);
    }

    // Axes that no test or expansion read go first, then whatever else the modules turn out not to depend on.
    Status stage(kf_stage_record& r, size_t s, const std::vector<uint32_t>& used, LeafMaps& maps,
                 const std::vector<uint32_t>& fields) {
        const StageClasses& classes = in_.stages[s];
        std::vector<LeafMaps::Ref> parts;
        for (size_t c = 0; c < classes.split->classes.size(); ++c) {
            const auto place = std::lower_bound(used.begin(), used.end(), in_.modules->of_class[s][c]) - used.begin();
            parts.push_back(maps.from_set(classes.split->classes[c].variants, static_cast<uint32_t>(place)));
        }
        auto map = maps.merge_all(std::move(parts));
        if (!map)
            return environment_error("two classes of the " + std::string(name_of(classes.stage)) + " stage of " +
                                     classes.space->shader + " claim the same variant");
        std::vector<bool> unread(fields.size(), true);
        for (const uint32_t axis : classes.split->axes_read) unread[axis] = false;
        if (const auto less = maps.forget(*map, unread)) map = less;
        for (const uint32_t axis : maps.support(*map)) {
            std::vector<bool> one(fields.size());
            one[axis] = true;
            if (const auto less = maps.forget(*map, one)) map = less;
        }
        std::vector<uint32_t> asked;
        r.stage = static_cast<uint32_t>(classes.stage);
        r.diagram = diagram(maps, maps.close(*map), fields, static_cast<uint32_t>(used.size()), &asked);
        r.axes = out_.append(kf_numbers, asked);
        return {};
    }

    void rules(kf_shader_record& r, Space& space, const std::vector<uint32_t>& fields) {
        std::vector<kf_rule_record> records;
        LeafMaps maps(*space.diagram);
        for (const Rule& rule : space.rules) {
            const Set holds = compile_expr(space, rule.expr);
            const Set broken = rule.forbid ? holds : space.diagram->complement(holds);
            const auto map = maps.merge(maps.from_set(broken, 1), maps.from_set(space.diagram->complement(broken), 0));
            records.push_back(
                {out_.text(rule.text), out_.text(rule.because), rule.forbid ? 1u : 0u, diagram(maps, *map, fields, 2)});
        }
        r.rules = out_.append(kf_rules, records);
    }

    void artifacts(kf_shader_record& r, uint32_t index, const std::vector<uint32_t>& used) {
        const auto& of = in_.artifacts->of;
        std::vector<uint32_t> map;
        std::vector<kf_text> reasons;
        for (uint32_t t = 0; t < in_.targets.size(); ++t)
            for (const uint32_t m : used) {
                uint32_t entry = KF_NO_ARTIFACT;
                if (in_.targets[t] != Target::spirv) {
                    if (index < of.size() && t < of[index].size() && m < of[index][t].size() && of[index][t][m] != no_artifact) {
                        entry = of[index][t][m];
                    } else {
                        const auto why = in_.artifacts->refusals.find({index, t, m});
                        const std::string reason = why == in_.artifacts->refusals.end() ? "it was not translated" : why->second;
                        entry = KF_HOLE | out_.one(kf_texts, out_.text(reason));
                    }
                }
                map.push_back(entry);
            }
        r.artifacts = out_.append(kf_numbers, map).first;
    }

    void slots(kf_shader_record& r, uint32_t index, const std::vector<uint32_t>& used) {
        if (index >= in_.artifacts->slots.size()) return;
        const std::vector<Slot>& slots = in_.artifacts->slots[index].slots;
        std::vector<kf_slot_record> records;
        for (const Slot& s : slots)
            records.push_back({out_.text(s.name), static_cast<uint32_t>(s.kind), s.set, s.binding, s.buffer, s.texture, s.sampler,
                               s.image, s.uav, s.metal_buffer, s.metal_texture, s.unit_offset, 0});
        r.slots = out_.append(kf_slots, records);
        std::vector<uint64_t> masks;
        for (const uint32_t m : used) {
            std::vector<uint64_t> mask((slots.size() + 63) / 64);
            for (const Resource& resource : in_.modules->list[m].reflection.resources)
                for (size_t i = 0; i < slots.size(); ++i)
                    if (same_slot(resource, slots[i])) mask[i / 64] |= uint64_t{1} << i % 64;
            masks.insert(masks.end(), mask.begin(), mask.end());
        }
        r.used = out_.append(kf_wides, masks).first;
    }

    static bool same_slot(const Resource& resource, const Slot& slot) {
        if (resource.kind != slot.kind) return false;
        return slot.kind == ResourceKind::push_constants || (resource.set == slot.set && resource.binding == slot.binding);
    }

    void pipelines(kf_shader_record& r, uint32_t index, const KeyLayout& layout) {
        std::vector<kf_pipeline_record> records;
        for (const Pipeline& p : in_.interfaces->pipelines)
            if (p.shader == index)
                records.push_back({out_.text(p.count.decimal()), out_.append(kf_numbers, p.modules).first,
                                   out_.append(kf_wides, pack_key(layout, p.witness)).first});
        r.pipelines = out_.append(kf_pipelines, records);
    }

    const TableInput& in_;
    const Jobs& jobs_;
    TableSections out_;
};

}  // namespace

std::vector<std::vector<size_t>> stages_by_shader(const std::vector<StageClasses>& stages) {
    std::vector<std::vector<size_t>> out;
    std::vector<const Shader*> seen;
    for (size_t i = 0; i < stages.size(); ++i) {
        const auto at = std::find(seen.begin(), seen.end(), stages[i].shader) - seen.begin();
        if (static_cast<size_t>(at) == seen.size()) {
            seen.push_back(stages[i].shader);
            out.emplace_back();
        }
        out[static_cast<size_t>(at)].push_back(i);
    }
    return out;
}

Result<TableFiles> write_table(const TableInput& input, const Jobs& jobs) {
    Result<Bytes> table = TableWriter(input, jobs).write();
    KILN_TRY(table);
    TableFiles files;
    files.table = std::move(*table);
    files.proof = write_proof(input, files.table);
    return files;
}

}  // namespace kiln
