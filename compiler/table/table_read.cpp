// Everything goes through the runtime reader, so that what our tools say about a table is what a game will get from it.

#include "compiler/table/table_read.h"

#include <algorithm>
#include <cstring>

#include "compiler/runtime/inspect.h"
#include "compiler/runtime/table_format.h"
#include "compiler/table/table_nodes.h"

namespace kiln {

namespace {

std::string string_of(kiln_text text) { return {text.data, text.size}; }

}  // namespace

Result<std::unique_ptr<TableView>> TableView::open(ByteView bytes) {
    std::unique_ptr<TableView> view(new TableView);
    view->size_ = bytes.size();
    view->storage_.resize((bytes.size() + 7) / 8);
    if (!bytes.empty()) std::memcpy(view->storage_.data(), bytes.data(), bytes.size());
    const kiln_status status = kiln_open(&view->table_, view->storage_.data(), view->size_);
    if (status != KILN_OK) return input_error(kiln_status_text(status));
    const char* what = nullptr;
    if (kiln_verify(&view->table_, &what) != KILN_OK) return input_error(std::string("the table is damaged: ") + what);
    kiln_get_info(&view->table_, &view->info_);
    for (uint32_t i = 0; i < view->info_.target_count; ++i) {
        const uint32_t target = kiln_get_target(&view->table_, i);
        if (target >= target_count) return input_error("the table has a target that this version of kiln does not know");
        view->targets_.push_back(static_cast<Target>(target));
    }
    for (uint32_t i = 0; i < view->info_.scene_count; ++i) view->scenes_.push_back(string_of(kiln_get_scene(&view->table_, i)));
    view->shaders_.resize(view->info_.shader_count);
    for (uint32_t i = 0; i < view->info_.shader_count; ++i)
        if (!view->read_shader(i, view->shaders_[i]))
            return input_error("the table is damaged: a shader's diagrams do not fit its axes");
    return view;
}

bool TableView::read_axes(TableShader& out) {
    std::vector<uint32_t> radices, order;
    for (uint32_t i = 0; i < out.raw.axis_count; ++i) {
        kiln_axis a;
        if (kiln_get_axis(&out.raw, i, &a) != KILN_OK || a.kind > static_cast<uint32_t>(AxisKind::defined)) return false;
        Axis axis;
        axis.name = string_of(a.name);
        axis.macro = string_of(a.macro);
        axis.kind = static_cast<AxisKind>(a.kind);
        for (uint32_t v = 0; v < a.value_count; ++v) {
            kiln_value value;
            kiln_get_value(&out.raw, i, v, &value);
            AxisValue to;
            to.name = string_of(value.name);
            to.number = value.number;
            axis.values.push_back(std::move(to));
        }
        if (a.value_count == 0 || a.value_count > 65535) return false;
        radices.push_back(a.value_count);
        out.space.axes.push_back(std::move(axis));
    }
    uint32_t count = 0;
    const uint32_t* axes = kiln_shader_order(&out.raw, &count);
    if (axes == nullptr || count != radices.size() || count >= 65535) return false;
    order.assign(axes, axes + count);
    std::vector<bool> seen(count);
    for (const uint32_t axis : order) {
        if (axis >= count || seen[axis]) return false;
        seen[axis] = true;
    }
    out.space.diagram = std::make_unique<Diagram>(std::move(radices), std::move(order));
    out.maps = std::make_unique<LeafMaps>(*out.space.diagram);
    return true;
}

std::optional<LeafMaps::Ref> TableView::read_map(TableShader& out, const kiln_diagram& from,
                                                 const std::vector<uint32_t>& fields) const {
    std::vector<uint32_t> words(from.words);
    if (from.words != 0) std::memcpy(words.data(), from.nodes, size_t{4} * from.words);
    return read_nodes(*out.maps, words, from.root, from.leaves, fields);
}

bool TableView::read_stages(TableShader& out, const std::vector<uint32_t>& fields) {
    std::vector<uint32_t> modules;
    for (uint32_t i = 0; i < out.raw.module_count; ++i) modules.push_back(kiln_shader_module(&out.raw, i));
    for (uint32_t i = 0; i < out.raw.stage_count; ++i) {
        if (out.raw.stage[i] >= stage_count) return false;
        TableStage stage;
        stage.stage = static_cast<Stage>(out.raw.stage[i]);
        stage.axes.resize(kiln_stage_axes(&out.raw, i, nullptr, 0));
        kiln_stage_axes(&out.raw, i, stage.axes.data(), static_cast<uint32_t>(stage.axes.size()));
        for (const uint32_t axis : stage.axes)
            if (axis >= out.space.axes.size()) return false;
        const auto map = read_map(out, out.raw.private_.stage[i], fields);
        if (!map) return false;
        stage.map = out.maps->relabel(*map, modules);
        out.stages.push_back(std::move(stage));
        for (const uint32_t m : modules)
            if (out.variants_of(i, m) != Diagram::none()) out.stages.back().modules.push_back(m);
    }
    return true;
}

bool TableView::read_rules(TableShader& out, const std::vector<uint32_t>& fields) {
    for (uint32_t i = 0; i < out.raw.rule_count; ++i) {
        kiln_rule rule;
        kiln_diagram diagram;
        if (kiln_get_rule(&out.raw, i, &rule) != KILN_OK || !kiln_shader_rule_diagram(&out.raw, i, &diagram)) return false;
        const auto map = read_map(out, diagram, fields);
        if (!map) return false;
        out.rules.push_back({string_of(rule.text), string_of(rule.because), rule.forbid != 0,
                             out.maps->to_set(*map, {false, true}, *out.space.diagram)});
    }
    return true;
}

bool TableView::read_shader(uint32_t index, TableShader& out) {
    if (kiln_get_shader(&table_, index, &out.raw) != KILN_OK || !read_axes(out)) return false;
    out.space.shader = string_of(out.raw.name);
    std::vector<uint32_t> fields;
    for (uint32_t i = 0; i < out.raw.axis_count; ++i) {
        kiln_axis a;
        kiln_get_axis(&out.raw, i, &a);
        fields.push_back(a.private_[1]);
    }
    const auto status = read_map(out, out.raw.private_.status, fields);
    if (!status) return false;
    out.space.needed = out.maps->to_set(*status, {false, false, true}, *out.space.diagram);
    out.space.legal = out.maps->to_set(*status, {false, true, true}, *out.space.diagram);
    if (!read_stages(out, fields) || !read_rules(out, fields)) return false;
    for (uint32_t i = 0; i < out.raw.pipeline_count; ++i) {
        kiln_pipeline p;
        if (kiln_get_pipeline(&out.raw, i, &p) != KILN_OK) return false;
        TablePipeline to;
        to.modules.assign(p.modules, p.modules + out.raw.stage_count);
        to.count = string_of(p.count);
        to.witness.resize(out.raw.axis_count);
        if (kiln_unpack(&out.raw, p.witness, to.witness.data()) != KILN_OK) return false;
        out.pipelines.push_back(std::move(to));
    }
    for (uint32_t i = 0; i < out.raw.slot_count; ++i) {
        kiln_slot s;
        if (kiln_get_slot(&out.raw, i, &s) != KILN_OK || s.kind > static_cast<uint32_t>(ResourceKind::push_constants))
            return false;
        Slot to;
        to.kind = static_cast<ResourceKind>(s.kind);
        to.set = s.set;
        to.binding = s.binding;
        to.name = string_of(s.name);
        to.buffer = s.buffer;
        to.texture = s.texture;
        to.sampler = s.sampler;
        to.image = s.image;
        to.uav = s.uav;
        to.metal_buffer = s.metal_buffer;
        to.metal_texture = s.metal_texture;
        to.unit_offset = s.unit_offset;
        out.slots.slots.push_back(std::move(to));
    }
    return !out.space.diagram->exhausted();
}

Set TableShader::variants_of(size_t stage, uint32_t module) {
    std::vector<bool> wanted(size_t{raw.table->section[kf_modules].count});
    wanted[module] = true;
    return space.diagram->both(maps->to_set(stages[stage].map, wanted, *space.diagram), space.needed);
}

TableShader* TableView::shader(const std::string& name) {
    for (TableShader& s : shaders_)
        if (s.space.shader == name) return &s;
    return nullptr;
}

TableModule TableView::module(uint32_t index) const {
    kiln_module m;
    TableModule out;
    if (kiln_get_module(&table_, index, &m) != KILN_OK) return out;
    out.stage = static_cast<Stage>(std::min(m.stage, stage_count - 1));
    out.words = {m.words, m.word_count};
    std::copy(m.digest, m.digest + out.digest.bytes.size(), out.digest.bytes.begin());
    return out;
}

std::vector<TableText> TableView::texts(const TableShader& shader, uint32_t module) const {
    std::vector<TableText> out;
    for (const Target target : targets_) {
        if (target == Target::spirv) continue;
        kiln_artifact a;
        const kiln_status status = kiln_find_artifact(&shader.raw, module, static_cast<uint32_t>(target), &a);
        TableText text;
        text.target = target;
        if (status == KILN_OK) {
            text.artifact = a.index;
            text.size = a.size;
        } else {
            text.refusal = status == KILN_REFUSED ? string_of(a.reason) : kiln_status_text(status);
        }
        out.push_back(std::move(text));
    }
    return out;
}

std::string TableView::text(uint32_t artifact) const {
    kiln_artifact a;
    if (kiln_get_artifact(&table_, artifact, &a) != KILN_OK) return {};
    std::string out(a.buffer, '\0');
    if (kiln_decode(&table_, artifact, out.data(), out.size()) != KILN_OK) return {};
    out.resize(a.size);
    return out;
}

}  // namespace kiln
