// Reflection as it is published: rebuilt from the runtime reader's answers, not from what the build had in hand.

#include "compiler/table/table_read.h"

namespace kiln {

namespace {

std::string string_of(kiln_text text) { return {text.data, text.size}; }

ValueType type_of(const kiln_type& type) {
    ValueType out;
    out.base = static_cast<BaseType>(type.base);
    out.rows = static_cast<uint8_t>(type.rows);
    out.columns = static_cast<uint8_t>(type.columns);
    out.array.assign(type.array, type.array + type.array_count);
    return out;
}

Member member_of(const kiln_member& m) {
    Member out;
    out.name = string_of(m.name);
    out.type = type_of(m.type);
    out.offset = m.offset;
    out.size = m.size;
    out.array_stride = m.array_stride;
    out.strides.assign(m.strides, m.strides + m.type.array_count);
    out.matrix_stride = m.matrix_stride;
    out.row_major = m.row_major != 0;
    return out;
}

Varying varying_of(const kiln_varying& v) {
    Varying out;
    out.name = string_of(v.name);
    out.location = v.location;
    out.component = v.component;
    out.index = v.index;
    out.type = type_of(v.type);
    out.flat = v.flat != 0;
    out.no_perspective = v.no_perspective != 0;
    out.centroid = v.centroid != 0;
    out.sample = v.sample != 0;
    out.patch = v.patch != 0;
    return out;
}

}  // namespace

Reflection TableView::reflection(uint32_t module) const {
    kiln_reflection r;
    Reflection out;
    if (kiln_get_reflection(&table_, module, &r) != KILN_OK) return out;
    out.stage = static_cast<Stage>(r.stage < stage_count ? r.stage : 0);
    out.entry = string_of(r.entry);
    for (size_t i = 0; i < 3; ++i) out.workgroup[i] = r.workgroup[i];
    out.writes_depth = r.writes_depth != 0;
    out.discards = r.discards != 0;
    for (uint32_t i = 0; i < r.resource_count; ++i) {
        kiln_resource from;
        if (kiln_get_resource(&table_, &r, i, &from) != KILN_OK) continue;
        Resource to;
        to.name = string_of(from.name);
        to.kind = static_cast<ResourceKind>(from.kind);
        to.set = from.set;
        to.binding = from.binding;
        to.array.assign(from.array, from.array + from.array_count);
        to.bytes = from.bytes;
        for (uint32_t m = 0; m < from.member_count; ++m) {
            kiln_member member;
            if (kiln_get_member(&table_, &from, m, &member) == KILN_OK) to.members.push_back(member_of(member));
        }
        to.dim = static_cast<ImageDim>(from.dim);
        to.arrayed = from.arrayed != 0;
        to.multisampled = from.multisampled != 0;
        to.depth = from.depth != 0;
        to.readonly = from.readonly != 0;
        to.writeonly = from.writeonly != 0;
        to.sampled = static_cast<BaseType>(from.sampled);
        to.format = from.format;
        out.resources.push_back(std::move(to));
    }
    kiln_varying v;
    for (uint32_t i = 0; i < r.input_count; ++i)
        if (kiln_get_input(&table_, &r, i, &v) == KILN_OK) out.inputs.push_back(varying_of(v));
    for (uint32_t i = 0; i < r.output_count; ++i)
        if (kiln_get_output(&table_, &r, i, &v) == KILN_OK) out.outputs.push_back(varying_of(v));
    return out;
}

}  // namespace kiln
