// Names. SPIRV-Cross falls back to ids (`_45`) where a name is missing or taken, and ids differ from variant to variant, so
// every resource gets a name that depends on its slot alone. GLSL 330 and ESSL 300 link varyings by name where Vulkan does by
// location: there a varying at location 3 is called io_loc3 on both sides, whatever its name was. A block's members are
// flattened by SPIRV-Cross to <variable>_<member>, hence the variable is called io and its member loc3.

#include "compiler/toolchain/edits.h"

#include <algorithm>

#include "compiler/reflect/spirv_enums.h"

namespace kiln {

Language language_of(Target target) {
    switch (target) {
        case Target::essl300:
        case Target::essl310:
            return Language::essl;
        case Target::hlsl50:
        case Target::hlsl60:
            return Language::hlsl;
        case Target::msl21:
        case Target::msl22:
        case Target::msl23:
        case Target::msl24:
        case Target::msl30:
            return Language::msl;
        default:
            return Language::glsl;
    }
}

unsigned version_of(Target target) {
    switch (target) {
        case Target::spirv:
            return 0;
        case Target::glsl330:
            return 330;
        case Target::glsl450:
            return 450;
        case Target::essl300:
            return 300;
        case Target::essl310:
            return 310;
        case Target::hlsl50:
            return 50;
        case Target::hlsl60:
            return 60;
        case Target::msl21:
            return 20100;
        case Target::msl22:
            return 20200;
        case Target::msl23:
            return 20300;
        case Target::msl24:
            return 20400;
        case Target::msl30:
            return 30000;
    }
    return 0;
}

bool links_by_name(Target target) { return target == Target::glsl330 || target == Target::essl300; }
bool has_bindings(Target target) { return !links_by_name(target); }

const Slot* find_slot(const SlotLayout& layout, const Resource& resource) {
    const bool push = resource.kind == ResourceKind::push_constants;
    for (const Slot& s : layout.slots)
        if (s.kind == resource.kind && (push || (s.set == resource.set && s.binding == resource.binding))) return &s;
    return nullptr;
}

const Slot* Edits::slot_of(uint32_t variable) const {
    for (const auto& [id, slot] : by_variable)
        if (id == variable) return &slot;
    return nullptr;
}

namespace {

uint32_t gl_number(const Slot& s) {
    switch (s.kind) {
        case ResourceKind::uniform_block:
        case ResourceKind::storage_block:
        case ResourceKind::push_constants:
            return s.buffer;
        case ResourceKind::storage_image:
        case ResourceKind::storage_texels:
            return s.image;
        default:
            return s.texture;
    }
}

bool is_block(ResourceKind kind) {
    return kind == ResourceKind::uniform_block || kind == ResourceKind::storage_block || kind == ResourceKind::push_constants;
}

// The other side of these is another stage; vertex inputs and fragment outputs face the application.
bool is_linked(const Reflection& r, uint32_t storage) {
    return storage == ir::sc_input ? r.stage != Stage::vertex : r.stage != Stage::fragment;
}

bool is_integer(const ir::View& view, uint32_t type) {
    const ir::Type& t = view.type(type);
    switch (t.kind) {
        case ir::Kind::integer:
            return true;
        case ir::Kind::vector:
        case ir::Kind::array:
            return is_integer(view, t.element);
        default:
            return false;
    }
}

std::string by_location(uint32_t location, uint32_t component) {
    std::string out = "loc" + std::to_string(location);
    if (component != 0) out += "c" + std::to_string(component);
    return out;
}

uint32_t bare_type(const ir::View& view, uint32_t type) {
    while (view.type(type).kind == ir::Kind::array || view.type(type).kind == ir::Kind::runtime_array)
        type = view.type(type).element;
    return type;
}

uint32_t or_zero(uint32_t number) { return number == ir::none ? 0 : number; }

uint32_t locations_of(const ir::View& view, uint32_t type) {
    const ir::Type& t = view.type(type);
    switch (t.kind) {
        case ir::Kind::array:
            return std::min(0xffffU, std::min(t.count, 0xffffU) * locations_of(view, t.element));
        case ir::Kind::matrix:
            return t.count * locations_of(view, t.element);
        case ir::Kind::vector:
            return view.type(t.element).width == 64 && t.count > 2 ? 2 : 1;
        case ir::Kind::structure: {
            uint32_t sum = 0;
            for (const uint32_t m : t.members) sum = std::min(0xffffU, sum + locations_of(view, m));
            return sum;
        }
        default:
            return 1;
    }
}

void rename_varying(const ir::View& view, const ir::Variable& variable, bool flattened, Edits& out) {
    const ir::Decorations& marks = view.marks(variable.id);
    const uint32_t bare = bare_type(view, variable.type);
    const ir::Type& t = view.type(bare);
    if (t.kind != ir::Kind::structure) {
        out.names.emplace_back(variable.id, "io_" + by_location(or_zero(marks.location), or_zero(marks.component)));
        return;
    }
    uint32_t location = or_zero(marks.location);
    out.names.emplace_back(variable.id, flattened ? "io" : "io_" + by_location(location, 0));
    out.names.emplace_back(bare, "io_type_" + by_location(location, 0));
    for (uint32_t m = 0; m < t.members.size(); ++m) {
        const ir::Decorations& member = view.member_marks(bare, m);
        if (member.location != ir::none) location = member.location;
        out.member_names.push_back({bare, m, by_location(location, or_zero(member.component))});
        location += locations_of(view, t.members[m]);
    }
}

// The reader's interpolation, where it is known; and integers are flat in any case, as GL wants it said on both sides. A
// structure that is no block has its interpolation on the variable, which SPIRV-Cross forgets when it takes it apart: its members
// are given it.
void plan_interpolation(const ir::View& view, const ir::Variable& variable, const SlotLayout& layout, Edits& out) {
    const ir::Decorations& marks = view.marks(variable.id);
    const uint32_t bare = bare_type(view, variable.type);
    const ir::Type& t = view.type(bare);
    const bool apart = t.kind == ir::Kind::structure && !view.marks(bare).block;
    const auto plan = [&](Edits::Interpolate what, uint32_t location, uint32_t type, const ir::Decorations& own) {
        what.how = {location, own.flat, own.no_perspective, own.centroid, own.sample};
        if (apart) {
            what.how.flat |= marks.flat;
            what.how.no_perspective |= marks.no_perspective;
            what.how.centroid |= marks.centroid;
            what.how.sample |= marks.sample;
        }
        const Interpolation said{location, own.flat, own.no_perspective, own.centroid, own.sample};
        const auto read = std::find_if(layout.interpolation.begin(), layout.interpolation.end(),
                                       [&](const Interpolation& i) { return i.location == location; });
        if (read != layout.interpolation.end()) what.how = *read;
        if (is_integer(view, type)) what.how.flat = true;
        if (apart || what.how != said) out.interpolate.push_back(what);
    };
    uint32_t location = or_zero(marks.location);
    if (t.kind != ir::Kind::structure) return plan({variable.id, false, 0, {}}, location, variable.type, marks);
    for (uint32_t m = 0; m < t.members.size(); ++m) {
        const ir::Decorations& member = view.member_marks(bare, m);
        if (member.location != ir::none) location = member.location;
        plan({bare, true, m, {}}, location, t.members[m], member);
        location += locations_of(view, t.members[m]);
    }
}

// A structure's members can be interpolated in one way only, however many varyings are made of it.
bool interpolated_in_two_ways(const Edits& edits) {
    for (const Edits::Interpolate& x : edits.interpolate)
        for (const Edits::Interpolate& y : edits.interpolate) {
            Interpolation other = y.how;
            other.location = x.how.location;
            if (x.is_member && y.is_member && x.id == y.id && x.member == y.member && other != x.how) return true;
        }
    return false;
}

void plan_varyings(const ir::View& view, const Reflection& reflection, Target target, const SlotLayout& layout, Edits& out) {
    const bool gl = language_of(target) == Language::glsl || language_of(target) == Language::essl;
    if (!gl) return;
    for (const ir::Variable& v : view.variables) {
        if (v.storage != ir::sc_input && v.storage != ir::sc_output) continue;
        if (!is_linked(reflection, v.storage) || view.marks(v.id).builtin != ir::none) continue;
        const uint32_t bare = bare_type(view, v.type);
        if (view.type(bare).kind == ir::Kind::structure && view.member_marks(bare, 0).builtin != ir::none) continue;
        if (links_by_name(target) || layout.flat_blocks) rename_varying(view, v, layout.flat_blocks, out);
        if (layout.flat_blocks && !links_by_name(target)) out.unplaced.push_back(v.id);
        const bool read_apart = v.storage == ir::sc_input && reflection.stage == Stage::fragment &&
                                view.type(bare).kind == ir::Kind::structure && !view.marks(bare).block;
        if (read_apart || (v.storage == ir::sc_output && reflection.stage == layout.rasterised))
            plan_interpolation(view, v, layout, out);
    }
}

}  // namespace

Result<Edits> plan_edits(const ir::View& view, const Reflected& reflected, Target target, const SlotLayout& layout) {
    Edits out;
    std::vector<const Slot*> seen;
    std::vector<uint32_t> types;
    for (const DeclaredResource& d : reflected.resources) {
        const Resource& r = d.resource;
        const Slot* slot = find_slot(layout, r);
        if (!slot) return input_error("'" + r.name + "' has no slot");
        out.separate |= r.kind == ResourceKind::separate_image || r.kind == ResourceKind::separate_sampler;
        const bool alias = std::find(seen.begin(), seen.end(), slot) != seen.end();
        seen.push_back(slot);
        if (!alias) out.slots.push_back(*slot);
        out.by_variable.emplace_back(d.variable, *slot);
        std::string name = slot->name;
        if (slot->by_stage && (language_of(target) == Language::glsl || language_of(target) == Language::essl))
            name += std::string("_") + name_of(reflected.reflection.stage);
        if (is_block(r.kind)) {
            // A type that two blocks share cannot carry the name; SPIRV-Cross then falls back to the variable's.
            const bool shared = std::find(types.begin(), types.end(), d.type) != types.end() ||
                                std::count_if(reflected.resources.begin(), reflected.resources.end(),
                                              [&](const DeclaredResource& o) { return o.type == d.type; }) > 1;
            types.push_back(d.type);
            const std::string& own = view.name(d.variable);
            if (shared) {
                out.names.emplace_back(d.type, "");
                out.names.emplace_back(d.variable, alias && !own.empty() ? own : name);
            } else {
                if (!alias) out.names.emplace_back(d.type, name);
                if (own.empty()) out.names.emplace_back(d.variable, slot->name + "_data");
            }
        } else if (!alias) {
            out.names.emplace_back(d.variable, name);
        }
        out.bindings.emplace_back(d.variable, gl_number(*slot));
    }
    plan_varyings(view, reflected.reflection, target, layout, out);
    if (interpolated_in_two_ways(out))
        return input_error("one structure is the type of two varyings that are interpolated differently");
    return out;
}

}  // namespace kiln
