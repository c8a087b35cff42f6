// Reflection straight from the words: SPIRV-Cross would parse the module into its own tree first, which costs more than
// all the rest of a warm build. Its answers serve as the oracle in the tests.

#include "compiler/reflect/reflect.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>

#include "compiler/reflect/module_resources.h"
#include "compiler/reflect/spirv_enums.h"

namespace kiln {
namespace {

using ir::Kind;
using ir::View;

constexpr size_t max_leaves = 65536;  // flattened members and varyings in a module

std::optional<Stage> stage_of(uint32_t model) {
    switch (model) {
        case 0:
            return Stage::vertex;
        case 1:
            return Stage::tess_control;
        case 2:
            return Stage::tess_evaluation;
        case 3:
            return Stage::geometry;
        case 4:
            return Stage::fragment;
        case 5:
            return Stage::compute;
        case 5267:
        case 5364:
            return Stage::task;
        case 5268:
        case 5365:
            return Stage::mesh;
        case 5313:
            return Stage::raygen;
        case 5314:
            return Stage::intersection;
        case 5315:
            return Stage::any_hit;
        case 5316:
            return Stage::closest_hit;
        case 5317:
            return Stage::miss;
        case 5318:
            return Stage::callable;
        default:
            return std::nullopt;
    }
}

BaseType base_of(const View& v, uint32_t type_id) {
    const ir::Type& t = v.type(type_id);
    switch (t.kind) {
        case Kind::vector:
        case Kind::matrix:
        case Kind::array:
        case Kind::runtime_array:
            return base_of(v, t.element);
        case Kind::boolean:
            return BaseType::boolean;
        case Kind::floating:
            return t.width == 16 ? BaseType::float16 : t.width == 64 ? BaseType::float64 : BaseType::float32;
        case Kind::integer:
            switch (t.width) {
                case 8:
                    return t.is_signed ? BaseType::int8 : BaseType::uint8;
                case 16:
                    return t.is_signed ? BaseType::int16 : BaseType::uint16;
                case 64:
                    return t.is_signed ? BaseType::int64 : BaseType::uint64;
                default:
                    return t.is_signed ? BaseType::int32 : BaseType::uint32;
            }
        case Kind::pointer:
            return BaseType::uint64;  // a buffer address
        default:
            return BaseType::structure;
    }
}

uint32_t bytes_of(BaseType base) {
    switch (base) {
        case BaseType::int8:
        case BaseType::uint8:
            return 1;
        case BaseType::float16:
        case BaseType::int16:
        case BaseType::uint16:
            return 2;
        case BaseType::float64:
        case BaseType::int64:
        case BaseType::uint64:
            return 8;
        case BaseType::structure:
            return 0;
        default:
            return 4;
    }
}

// The type without its arrays; their lengths (0: at run time) and strides are appended, outermost first.
uint32_t strip_arrays(const View& v, uint32_t type_id, std::vector<uint32_t>& lengths, std::vector<uint32_t>* strides = nullptr) {
    for (;;) {
        const ir::Type& t = v.type(type_id);
        if (t.kind != Kind::array && t.kind != Kind::runtime_array) return type_id;
        lengths.push_back(t.kind == Kind::array ? t.count : 0);
        if (strides) strides->push_back(v.marks(type_id).array_stride == ir::none ? 0 : v.marks(type_id).array_stride);
        type_id = t.element;
    }
}

ValueType value_of(const View& v, uint32_t bare_type) {
    ValueType out;
    const ir::Type& t = v.type(bare_type);
    out.base = base_of(v, bare_type);
    if (t.kind == Kind::vector) out.rows = static_cast<uint8_t>(t.count);
    if (t.kind == Kind::matrix) {
        out.columns = static_cast<uint8_t>(t.count);
        out.rows = static_cast<uint8_t>(v.type(t.element).count);
    }
    return out;
}

class Reflector {
public:
    explicit Reflector(const View& view) : v_(view) {}

    Result<Reflected> run() {
        const std::optional<Stage> stage = stage_of(v_.model);
        if (!stage) return input_error("SPIR-V: execution model " + std::to_string(v_.model) + " is none of Vulkan's");
        out_.stage = *stage;
        out_.entry = v_.entry;
        if (*stage == Stage::compute || *stage == Stage::task || *stage == Stage::mesh) out_.workgroup = v_.workgroup;
        out_.writes_depth = v_.depth_replacing;
        scan_body();
        for (const ir::Variable& variable : v_.variables) {
            if (variable.storage == ir::sc_input || variable.storage == ir::sc_output)
                varying(variable);
            else
                resource(variable);
        }
        if (leaves_ > max_leaves) return input_error("SPIR-V: more than 65,536 members in interfaces");
        sort();
        return Reflected{std::move(out_), std::move(ids_)};
    }

private:
    struct Leaf {
        std::string name;
        uint32_t offset = 0;
        std::vector<uint32_t> array, strides;
        bool row_major = false;
        uint32_t matrix_stride = ir::none;
    };

    // Which variables are compared against: a sampled image is depth by what is done with it, since a separate image's own
    // type does not say.
    void scan_body() {
        std::unordered_map<uint32_t, std::vector<uint32_t>> from;  // value or pointer id -> variables it comes from
        for (const ir::Variable& variable : v_.variables) from[variable.id] = {variable.id};
        for (const ir::Instruction& i : v_.body) {
            switch (i.op) {
                case ir::op_load:
                case ir::op_access_chain:
                case ir::op_in_bounds_access_chain:
                case ir::op_copy_object:
                case ir::op_image: {
                    const auto found = from.find(v_.word(i, 3));
                    if (found != from.end()) from[v_.word(i, 2)] = std::vector<uint32_t>(found->second);
                    break;
                }
                case ir::op_sampled_image: {
                    std::vector<uint32_t> both;
                    for (const uint32_t n : {3U, 4U}) {
                        const auto found = from.find(v_.word(i, n));
                        if (found != from.end()) both.insert(both.end(), found->second.begin(), found->second.end());
                    }
                    from[v_.word(i, 2)] = std::move(both);
                    break;
                }
                case ir::op_image_sample_dref_implicit_lod:
                case ir::op_image_sample_dref_explicit_lod:
                case ir::op_image_sample_proj_dref_implicit_lod:
                case ir::op_image_sample_proj_dref_explicit_lod:
                case ir::op_image_dref_gather: {
                    const auto found = from.find(v_.word(i, 3));
                    if (found != from.end()) compared_.insert(found->second.begin(), found->second.end());
                    break;
                }
                case ir::op_kill:
                case ir::op_terminate_invocation:
                case ir::op_demote:
                    out_.discards = true;
                    break;
                default:
                    break;
            }
        }
    }

    void flatten(Resource& block, uint32_t type_id, const Leaf& at) {
        const ir::Type& s = v_.type(type_id);
        for (uint32_t m = 0; m < s.members.size() && leaves_ <= max_leaves; ++m) {
            const ir::Decorations& marks = v_.member_marks(type_id, m);
            Leaf leaf = at;
            const std::string& name = v_.member_name(type_id, m);
            if (!leaf.name.empty()) leaf.name += '.';
            leaf.name += name.empty() ? "_m" + std::to_string(m) : name;
            leaf.offset += marks.offset == ir::none ? 0 : marks.offset;
            const size_t outer = leaf.array.size();
            const uint32_t bare = strip_arrays(v_, s.members[m], leaf.array, &leaf.strides);
            if (marks.matrix_stride != ir::none) leaf.matrix_stride = marks.matrix_stride;
            leaf.row_major = marks.row_major;
            if (v_.type(bare).kind == Kind::structure) {
                if (leaf.array.size() > outer) leaf.name += "[]";
                flatten(block, bare, leaf);
            } else {
                block.members.push_back(member(bare, leaf, outer));
                ++leaves_;
            }
        }
    }

    Member member(uint32_t bare, const Leaf& leaf, size_t outer) const {
        Member m;
        m.name = leaf.name;
        m.type = value_of(v_, bare);
        m.type.array = leaf.array;
        m.offset = leaf.offset;
        m.strides = leaf.strides;
        m.array_stride = leaf.strides.empty() ? 0 : leaf.strides.back();
        if (v_.type(bare).kind == Kind::matrix) {
            m.row_major = leaf.row_major;
            m.matrix_stride = leaf.matrix_stride == ir::none ? 0 : leaf.matrix_stride;
        }
        m.size = leaf.array.size() > outer ? leaf.strides[outer] * leaf.array[outer] : bare_size(m);
        return m;
    }

    static uint32_t bare_size(const Member& m) {
        if (m.type.columns > 1) return m.matrix_stride * (m.row_major ? m.type.rows : m.type.columns);
        return bytes_of(m.type.base) * m.type.rows;
    }

    // Declared size of a structure: to the end of the member that ends last; its run-time array counts as nothing.
    uint32_t struct_size(uint32_t type_id) const {
        const ir::Type& s = v_.type(type_id);
        uint32_t end = 0;
        for (uint32_t m = 0; m < s.members.size(); ++m) {
            const ir::Decorations& marks = v_.member_marks(type_id, m);
            const uint32_t offset = marks.offset == ir::none ? 0 : marks.offset;
            std::vector<uint32_t> lengths, strides;
            const uint32_t bare = strip_arrays(v_, s.members[m], lengths, &strides);
            uint32_t size = 0;
            if (!lengths.empty()) {
                size = lengths[0] * strides[0];
            } else if (v_.type(bare).kind == Kind::structure) {
                size = struct_size(bare);
            } else {
                Member leaf;
                leaf.type = value_of(v_, bare);
                leaf.matrix_stride = marks.matrix_stride == ir::none ? 0 : marks.matrix_stride;
                leaf.row_major = marks.row_major;
                size = bare_size(leaf);
            }
            end = std::max(end, offset + size);
        }
        return end;
    }

    void resource(const ir::Variable& variable) {
        Resource r;
        const uint32_t bare = strip_arrays(v_, variable.type, r.array);
        const ir::Type& t = v_.type(bare);
        const ir::Decorations& marks = v_.marks(variable.id);
        if (!classify(variable, bare, r)) return;
        if (r.kind != ResourceKind::push_constants) {
            r.set = marks.set == ir::none ? 0 : marks.set;
            r.binding = marks.binding == ir::none ? 0 : marks.binding;
        }
        const bool block = t.kind == Kind::structure;
        r.name = block && !v_.name(bare).empty() ? v_.name(bare) : v_.name(variable.id);
        if (r.name.empty())
            r.name = r.kind == ResourceKind::push_constants ? "push_constants"
                                                            : "r" + std::to_string(r.set) + "_" + std::to_string(r.binding);
        if (block) {
            flatten(r, bare, {});
            r.bytes = struct_size(bare);
        }
        if (r.kind == ResourceKind::storage_block || r.kind == ResourceKind::storage_image ||
            r.kind == ResourceKind::storage_texels) {
            bool all_readonly = block && !t.members.empty(), all_writeonly = all_readonly;
            for (uint32_t m = 0; block && m < t.members.size(); ++m) {
                all_readonly &= v_.member_marks(bare, m).non_writable;
                all_writeonly &= v_.member_marks(bare, m).non_readable;
            }
            r.readonly = marks.non_writable || all_readonly;
            r.writeonly = marks.non_readable || all_writeonly;
        }
        ids_.push_back({variable.id, bare, std::move(r)});
    }

    bool classify(const ir::Variable& variable, uint32_t bare, Resource& r) const {
        const ir::Type& t = v_.type(bare);
        switch (variable.storage) {
            case ir::sc_push_constant:
                r.kind = ResourceKind::push_constants;
                return true;
            case ir::sc_storage_buffer:
                r.kind = ResourceKind::storage_block;
                return true;
            case ir::sc_uniform:
                r.kind = v_.marks(bare).buffer_block ? ResourceKind::storage_block : ResourceKind::uniform_block;
                return true;
            case ir::sc_uniform_constant:
                break;
            default:
                return false;
        }
        if (t.kind == Kind::acceleration_structure) {
            r.kind = ResourceKind::acceleration_structure;
            return true;
        }
        if (t.kind == Kind::sampler) {
            r.kind = ResourceKind::separate_sampler;
            r.depth = compared_.count(variable.id) != 0;
            return true;
        }
        const ir::Type& image = t.kind == Kind::sampled_image ? v_.type(t.element) : t;
        if (image.kind != Kind::image) return false;
        r.dim = image.dim > ir::dim_subpass ? ImageDim::none : static_cast<ImageDim>(image.dim + 1);
        r.arrayed = image.arrayed;
        r.multisampled = image.multisampled;
        r.depth = compared_.count(variable.id) != 0 || (t.kind == Kind::sampled_image && image.depth == 1);
        r.sampled = base_of(v_, image.element);
        if (image.dim == ir::dim_subpass)
            r.kind = ResourceKind::input_attachment;
        else if (t.kind == Kind::sampled_image)
            r.kind = image.dim == ir::dim_buffer ? ResourceKind::uniform_texels : ResourceKind::combined_image;
        else if (image.sampled == 2)
            r.kind = image.dim == ir::dim_buffer ? ResourceKind::storage_texels : ResourceKind::storage_image;
        else
            r.kind = image.dim == ir::dim_buffer ? ResourceKind::uniform_texels : ResourceKind::separate_image;
        if (image.sampled == 2) r.format = image.format;
        return true;
    }

    // True where SPIR-V puts an array of vertices around the variable.
    bool per_vertex(const ir::Variable& variable) const {
        if (v_.marks(variable.id).patch) return false;
        if (v_.marks(variable.id).per_vertex) return true;
        if (variable.storage == ir::sc_input)
            return out_.stage == Stage::tess_control || out_.stage == Stage::tess_evaluation || out_.stage == Stage::geometry;
        return out_.stage == Stage::tess_control || out_.stage == Stage::mesh;
    }

    static uint32_t locations_of(const ValueType& type) {
        const bool wide = bytes_of(type.base) == 8 && type.rows > 2;
        uint64_t n = uint64_t{type.columns} * (wide ? 2 : 1);
        for (const uint32_t length : type.array) n = std::min<uint64_t>(n * std::max(length, 1U), 0xffffff);
        return static_cast<uint32_t>(n);
    }

    void varying(const ir::Variable& variable) {
        const ir::Decorations& marks = v_.marks(variable.id);
        if (marks.builtin != ir::none) return;
        Varying base;
        uint32_t type_id = variable.type;
        if (per_vertex(variable) && v_.type(type_id).kind == Kind::array) type_id = v_.type(type_id).element;
        std::vector<uint32_t> lengths;
        const uint32_t bare = strip_arrays(v_, type_id, lengths);
        const bool block = v_.type(bare).kind == Kind::structure && v_.marks(bare).block;
        base.name = block ? v_.name(bare) : v_.name(variable.id);
        if (block && !v_.type(bare).members.empty() && v_.member_marks(bare, 0).builtin != ir::none) return;  // gl_PerVertex
        base.component = marks.component == ir::none ? 0 : marks.component;
        base.index = marks.index == ir::none ? 0 : marks.index;
        qualify(base, marks);
        uint32_t location = marks.location == ir::none ? 0 : marks.location;
        auto& list = variable.storage == ir::sc_input ? out_.inputs : out_.outputs;
        expand(list, bare, lengths, base, location);
    }

    static void qualify(Varying& v, const ir::Decorations& marks) {
        v.flat |= marks.flat;
        v.no_perspective |= marks.no_perspective;
        v.centroid |= marks.centroid;
        v.sample |= marks.sample;
        v.patch |= marks.patch;
    }

    void expand(std::vector<Varying>& list, uint32_t bare, const std::vector<uint32_t>& lengths, Varying base,
                uint32_t& location) {
        if (leaves_ > max_leaves) return;
        const ir::Type& t = v_.type(bare);
        if (t.kind != Kind::structure) {
            base.type = value_of(v_, bare);
            base.type.array = lengths;
            base.location = location;
            location += locations_of(base.type);
            list.push_back(std::move(base));
            ++leaves_;
            return;
        }
        uint64_t copies = 1;
        for (const uint32_t length : lengths) copies = std::min<uint64_t>(copies * std::max(length, 1U), max_leaves + 1);
        for (uint64_t copy = 0; copy < copies && leaves_ <= max_leaves; ++copy) {
            if (t.members.empty()) break;
            for (uint32_t m = 0; m < t.members.size(); ++m) {
                const ir::Decorations& marks = v_.member_marks(bare, m);
                if (marks.builtin != ir::none) continue;
                Varying v = base;
                if (!lengths.empty()) v.name += "[" + std::to_string(copy) + "]";
                const std::string& name = v_.member_name(bare, m);
                v.name += (v.name.empty() ? "" : ".") + (name.empty() ? "_m" + std::to_string(m) : name);
                if (marks.location != ir::none && copy == 0) location = marks.location;
                if (marks.component != ir::none) v.component = marks.component;
                qualify(v, marks);
                std::vector<uint32_t> inner;
                const uint32_t member_type = strip_arrays(v_, t.members[m], inner);
                expand(list, member_type, inner, std::move(v), location);
            }
        }
    }

    void sort() {
        std::stable_sort(ids_.begin(), ids_.end(), [](const DeclaredResource& x, const DeclaredResource& y) {
            const Resource &a = x.resource, &b = y.resource;
            const bool pa = a.kind == ResourceKind::push_constants, pb = b.kind == ResourceKind::push_constants;
            return std::tie(pa, a.set, a.binding, a.kind, a.name) < std::tie(pb, b.set, b.binding, b.kind, b.name);
        });
        const auto by_place = [](const Varying& a, const Varying& b) {
            return std::tie(a.location, a.component, a.index) < std::tie(b.location, b.component, b.index);
        };
        std::stable_sort(out_.inputs.begin(), out_.inputs.end(), by_place);
        std::stable_sort(out_.outputs.begin(), out_.outputs.end(), by_place);
    }

    const View& v_;
    Reflection out_;
    std::vector<DeclaredResource> ids_;
    std::set<uint32_t> compared_;
    size_t leaves_ = 0;
};

}  // namespace

Result<Reflected> reflect_view(const View& view) { return Reflector(view).run(); }

Result<Reflection> reflect_words(WordView words) {
    const Result<View> view = ir::read_view(words);
    if (!view) return view.error();
    Result<Reflected> out = reflect_view(*view);
    if (!out) return out.error();
    for (DeclaredResource& r : out->resources) out->reflection.resources.push_back(std::move(r.resource));
    return std::move(out->reflection);
}

}  // namespace kiln
