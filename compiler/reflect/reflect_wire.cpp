// Field by field in the order of declaration; enums and small counts are checked on the way in, since a record may come from
// another machine's store.

#include "compiler/reflect/reflect_wire.h"

namespace kiln {
namespace {

void write_array(WireWriter& out, const std::vector<uint32_t>& array) {
    out.u64(array.size());
    for (const uint32_t n : array) out.u32(n);
}

std::vector<uint32_t> read_array(WireReader& in) {
    std::vector<uint32_t> array(in.count(4));
    for (uint32_t& n : array) n = in.u32();
    return array;
}

template <class Enum>
Enum read_enum(WireReader& in, Enum last) {
    const uint8_t v = in.u8();
    if (v > static_cast<uint8_t>(last)) in.fail();
    return static_cast<Enum>(v);
}

bool read_flag(WireReader& in) {
    const uint8_t v = in.u8();
    if (v > 1) in.fail();
    return v == 1;
}

void write_type(WireWriter& out, const ValueType& t) {
    out.u8(static_cast<uint8_t>(t.base));
    out.u8(t.rows);
    out.u8(t.columns);
    write_array(out, t.array);
}

ValueType read_type(WireReader& in) {
    ValueType t;
    t.base = read_enum(in, BaseType::structure);
    t.rows = in.u8();
    t.columns = in.u8();
    t.array = read_array(in);
    return t;
}

void write_member(WireWriter& out, const Member& m) {
    out.text(m.name);
    write_type(out, m.type);
    for (const uint32_t n : {m.offset, m.size, m.array_stride, m.matrix_stride}) out.u32(n);
    write_array(out, m.strides);
    out.u8(m.row_major);
}

Member read_member(WireReader& in) {
    Member m;
    m.name = in.text();
    m.type = read_type(in);
    for (uint32_t* n : {&m.offset, &m.size, &m.array_stride, &m.matrix_stride}) *n = in.u32();
    m.strides = read_array(in);
    m.row_major = read_flag(in);
    return m;
}

void write_resource(WireWriter& out, const Resource& r) {
    out.text(r.name);
    out.u8(static_cast<uint8_t>(r.kind));
    out.u32(r.set);
    out.u32(r.binding);
    write_array(out, r.array);
    out.u32(r.bytes);
    out.u64(r.members.size());
    for (const Member& m : r.members) write_member(out, m);
    out.u8(static_cast<uint8_t>(r.dim));
    for (const bool flag : {r.arrayed, r.multisampled, r.depth, r.readonly, r.writeonly}) out.u8(flag);
    out.u8(static_cast<uint8_t>(r.sampled));
    out.u32(r.format);
}

constexpr size_t least_member = 8 + 3 + 8 + 16 + 8 + 1;
constexpr size_t least_resource = 8 + 1 + 8 + 8 + 4 + 8 + 1 + 5 + 1 + 4;
constexpr size_t least_varying = 8 + 12 + 3 + 8 + 5;

Resource read_resource(WireReader& in) {
    Resource r;
    r.name = in.text();
    r.kind = read_enum(in, ResourceKind::push_constants);
    r.set = in.u32();
    r.binding = in.u32();
    r.array = read_array(in);
    r.bytes = in.u32();
    const size_t members = in.count(least_member);
    for (size_t i = 0; i < members && in.ok(); ++i) r.members.push_back(read_member(in));
    r.dim = read_enum(in, ImageDim::subpass);
    for (bool* flag : {&r.arrayed, &r.multisampled, &r.depth, &r.readonly, &r.writeonly}) *flag = read_flag(in);
    r.sampled = read_enum(in, BaseType::structure);
    r.format = in.u32();
    return r;
}

void write_varyings(WireWriter& out, const std::vector<Varying>& list) {
    out.u64(list.size());
    for (const Varying& v : list) {
        out.text(v.name);
        for (const uint32_t n : {v.location, v.component, v.index}) out.u32(n);
        write_type(out, v.type);
        for (const bool flag : {v.flat, v.no_perspective, v.centroid, v.sample, v.patch}) out.u8(flag);
    }
}

std::vector<Varying> read_varyings(WireReader& in) {
    std::vector<Varying> list;
    const size_t count = in.count(least_varying);
    for (size_t i = 0; i < count && in.ok(); ++i) {
        Varying v;
        v.name = in.text();
        for (uint32_t* n : {&v.location, &v.component, &v.index}) *n = in.u32();
        v.type = read_type(in);
        for (bool* flag : {&v.flat, &v.no_perspective, &v.centroid, &v.sample, &v.patch}) *flag = read_flag(in);
        list.push_back(std::move(v));
    }
    return list;
}

}  // namespace

void write_reflection(WireWriter& out, const Reflection& reflection) {
    out.u8(static_cast<uint8_t>(reflection.stage));
    out.text(reflection.entry);
    out.u64(reflection.resources.size());
    for (const Resource& r : reflection.resources) write_resource(out, r);
    write_varyings(out, reflection.inputs);
    write_varyings(out, reflection.outputs);
    for (const uint32_t n : reflection.workgroup) out.u32(n);
    out.u8(reflection.writes_depth);
    out.u8(reflection.discards);
}

bool read_reflection(WireReader& in, Reflection& reflection) {
    reflection = Reflection();
    reflection.stage = read_enum(in, Stage::callable);
    reflection.entry = in.text();
    const size_t resources = in.count(least_resource);
    for (size_t i = 0; i < resources && in.ok(); ++i) reflection.resources.push_back(read_resource(in));
    reflection.inputs = read_varyings(in);
    reflection.outputs = read_varyings(in);
    for (uint32_t& n : reflection.workgroup) n = in.u32();
    reflection.writes_depth = read_flag(in);
    reflection.discards = read_flag(in);
    return in.ok();
}

}  // namespace kiln
