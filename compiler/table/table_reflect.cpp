#include "compiler/table/table_reflect.h"

namespace kiln {

namespace {

kf_type_record type_record(TableSections& out, const ValueType& type) {
    return {static_cast<uint32_t>(type.base), type.rows, type.columns, 0, out.list(kf_numbers, type.array)};
}

uint32_t flag(bool set, uint32_t value) { return set ? value : 0; }

kf_range members(TableSections& out, const std::vector<Member>& list) {
    std::vector<kf_member_record> records;
    for (const Member& m : list) {
        kf_member_record r{};
        r.name = out.text(m.name);
        r.type = type_record(out, m.type);
        std::vector<uint32_t> strides = m.strides;
        strides.resize(m.type.array.size());
        r.strides = out.list(kf_numbers, strides);
        r.offset = m.offset;
        r.size = m.size;
        r.array_stride = m.array_stride;
        r.matrix_stride = m.matrix_stride;
        r.flags = flag(m.row_major, kf_row_major);
        records.push_back(r);
    }
    return out.list(kf_members, records);
}

kf_range resources(TableSections& out, const std::vector<Resource>& list) {
    std::vector<kf_resource_record> records;
    for (const Resource& resource : list) {
        kf_resource_record r{};
        r.name = out.text(resource.name);
        r.kind = static_cast<uint32_t>(resource.kind);
        r.set = resource.set;
        r.binding = resource.binding;
        r.bytes = resource.bytes;
        r.array = out.list(kf_numbers, resource.array);
        r.members = members(out, resource.members);
        r.dim = static_cast<uint32_t>(resource.dim);
        r.flags = flag(resource.arrayed, kf_arrayed) | flag(resource.multisampled, kf_multisampled) |
                  flag(resource.depth, kf_depth) | flag(resource.readonly, kf_readonly) | flag(resource.writeonly, kf_writeonly);
        r.sampled = static_cast<uint32_t>(resource.sampled);
        r.format = resource.format;
        records.push_back(r);
    }
    return out.list(kf_resources, records);
}

kf_range varyings(TableSections& out, const std::vector<Varying>& list) {
    std::vector<kf_varying_record> records;
    for (const Varying& v : list) {
        kf_varying_record r{};
        r.name = out.text(v.name);
        r.type = type_record(out, v.type);
        r.location = v.location;
        r.component = v.component;
        r.index = v.index;
        r.flags = flag(v.flat, kf_flat) | flag(v.no_perspective, kf_no_perspective) | flag(v.centroid, kf_centroid) |
                  flag(v.sample, kf_sample) | flag(v.patch, kf_patch);
        records.push_back(r);
    }
    return out.list(kf_varyings, records);
}

}  // namespace

uint32_t write_reflection(TableSections& out, const Reflection& reflection) {
    kf_reflection_record r{};
    r.entry = out.text(reflection.entry);
    r.stage = static_cast<uint32_t>(reflection.stage);
    r.flags = flag(reflection.writes_depth, kf_writes_depth) | flag(reflection.discards, kf_discards);
    for (size_t i = 0; i < 3; ++i) r.workgroup[i] = reflection.workgroup[i];
    r.resources = resources(out, reflection.resources);
    r.inputs = varyings(out, reflection.inputs);
    r.outputs = varyings(out, reflection.outputs);
    return out.one(kf_reflections, r);
}

}  // namespace kiln
