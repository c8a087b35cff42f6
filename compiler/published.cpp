#include "compiler/published.h"

namespace kiln {

namespace {

Error damaged() { return input_error("the table is damaged: a reflection record does not fit"); }

std::vector<uint32_t> numbers(const uint32_t* data, uint32_t count) {
    return data == nullptr ? std::vector<uint32_t>() : std::vector<uint32_t>(data, data + count);
}

bool type_of(const kiln_type& from, ValueType& to) {
    if (from.base > static_cast<uint32_t>(BaseType::structure)) return false;
    to.base = static_cast<BaseType>(from.base);
    to.rows = static_cast<uint8_t>(from.rows);
    to.columns = static_cast<uint8_t>(from.columns);
    to.array = numbers(from.array, from.array_count);
    return true;
}

bool varying_of(const kiln_varying& from, Varying& to) {
    to.name = text_of(from.name);
    to.location = from.location;
    to.component = from.component;
    to.index = from.index;
    to.flat = from.flat != 0;
    to.no_perspective = from.no_perspective != 0;
    to.centroid = from.centroid != 0;
    to.sample = from.sample != 0;
    to.patch = from.patch != 0;
    return type_of(from.type, to.type);
}

bool resource_of(const kiln_table& table, const kiln_resource& from, Resource& to) {
    if (from.kind > static_cast<uint32_t>(ResourceKind::push_constants) || from.dim > static_cast<uint32_t>(ImageDim::subpass) ||
        from.sampled > static_cast<uint32_t>(BaseType::structure))
        return false;
    to.name = text_of(from.name);
    to.kind = static_cast<ResourceKind>(from.kind);
    to.set = from.set;
    to.binding = from.binding;
    to.array = numbers(from.array, from.array_count);
    to.bytes = from.bytes;
    to.dim = static_cast<ImageDim>(from.dim);
    to.arrayed = from.arrayed != 0;
    to.multisampled = from.multisampled != 0;
    to.depth = from.depth != 0;
    to.readonly = from.readonly != 0;
    to.writeonly = from.writeonly != 0;
    to.sampled = static_cast<BaseType>(from.sampled);
    to.format = from.format;
    for (uint32_t i = 0; i < from.member_count; ++i) {
        kiln_member m;
        Member member;
        if (kiln_get_member(&table, &from, i, &m) != KILN_OK || !type_of(m.type, member.type)) return false;
        member.name = text_of(m.name);
        member.offset = m.offset;
        member.size = m.size;
        member.array_stride = m.array_stride;
        member.strides = numbers(m.strides, m.type.array_count);
        member.matrix_stride = m.matrix_stride;
        member.row_major = m.row_major != 0;
        to.members.push_back(std::move(member));
    }
    return true;
}

// The slot of a resource: same kind and name, used by the module; among several, the one at the same numbers.
bool find_slot(const kiln_shader& shader, uint32_t module, Resource& r) {
    bool found = false;
    uint32_t set = 0, binding = 0;
    for (uint32_t i = 0; i < shader.slot_count; ++i) {
        kiln_slot slot;
        if (kiln_get_slot(&shader, i, &slot) != KILN_OK || kiln_uses_slot(&shader, module, i) == 0) continue;
        if (slot.kind != static_cast<uint32_t>(r.kind) || text_of(slot.name) != r.name) continue;
        if (found && (set != r.set || binding != r.binding)) found = false;
        if (found) continue;
        found = true;
        set = slot.set;
        binding = slot.binding;
    }
    if (!found) return false;
    if (r.kind != ResourceKind::push_constants) r.set = set, r.binding = binding;
    return true;
}

}  // namespace

std::string text_of(kiln_text text) { return std::string(text.data, text.size); }

std::vector<Axis> published_axes(const kiln_shader& shader) {
    std::vector<Axis> out;
    for (uint32_t a = 0; a < shader.axis_count; ++a) {
        kiln_axis from;
        Axis to;
        if (kiln_get_axis(&shader, a, &from) != KILN_OK) return {};
        to.name = text_of(from.name);
        to.macro = text_of(from.macro);
        to.kind = static_cast<AxisKind>(from.kind);
        for (uint32_t d = 0; d < from.value_count; ++d) {
            kiln_value v;
            if (kiln_get_value(&shader, a, d, &v) != KILN_OK) return {};
            to.values.push_back({text_of(v.name), v.number});
        }
        out.push_back(std::move(to));
    }
    return out;
}

Result<StageCode> published_stage(const kiln_table& table, const kiln_shader& shader, uint32_t module) {
    kiln_module code;
    kiln_reflection about;
    if (kiln_get_module(&table, module, &code) != KILN_OK || kiln_get_reflection(&table, module, &about) != KILN_OK ||
        code.stage >= stage_count)
        return damaged();
    StageCode out;
    out.stage = static_cast<Stage>(code.stage);
    out.words.assign(code.words, code.words + code.word_count);
    Reflection& r = out.reflection;
    r.stage = out.stage;
    r.entry = text_of(about.entry);
    r.workgroup = {about.workgroup[0], about.workgroup[1], about.workgroup[2]};
    r.writes_depth = about.writes_depth != 0;
    r.discards = about.discards != 0;
    for (uint32_t i = 0; i < about.resource_count; ++i) {
        kiln_resource from;
        Resource to;
        if (kiln_get_resource(&table, &about, i, &from) != KILN_OK || !resource_of(table, from, to)) return damaged();
        if (!find_slot(shader, module, to))
            return input_error("resource '" + to.name + "' of a module of " + text_of(shader.name) + " has no published slot");
        r.resources.push_back(std::move(to));
    }
    for (uint32_t i = 0; i < about.input_count + about.output_count; ++i) {
        const bool input = i < about.input_count;
        kiln_varying from;
        Varying to;
        const kiln_status status =
            input ? kiln_get_input(&table, &about, i, &from) : kiln_get_output(&table, &about, i - about.input_count, &from);
        if (status != KILN_OK || !varying_of(from, to)) return damaged();
        (input ? r.inputs : r.outputs).push_back(std::move(to));
    }
    return out;
}

std::string published_variant(const kiln_shader& shader, const uint64_t* key) {
    std::string out;
    for (uint32_t a = 0; a < shader.axis_count; ++a) {
        kiln_axis axis;
        kiln_value value;
        if (kiln_get_axis(&shader, a, &axis) != KILN_OK ||
            kiln_get_value(&shader, a, kiln_key_get(&shader, key, a), &value) != KILN_OK)
            continue;
        if (!out.empty()) out += ' ';
        out += text_of(axis.name) + '=' + text_of(value.name);
    }
    return out;
}

}  // namespace kiln
