// One walk over types, variables and instructions. A built-in counts as used only where something reaches it: every vertex
// shader declares gl_CullDistance with the rest of gl_PerVertex.

#include <unordered_map>
#include <unordered_set>

#include "compiler/reflect/spirv_enums.h"
#include "compiler/toolchain/limits.h"

namespace kiln {
namespace {

using ir::Kind;
using ir::View;

// GLSL.std.450's numbers.
enum Std450 : uint32_t {
    std_frexp = 51,
    std_frexp_struct = 52,
    std_ldexp = 53,
    std_pack_snorm4x8 = 54,
    std_pack_unorm4x8 = 55,
    std_pack_snorm2x16 = 56,
    std_pack_unorm2x16 = 57,
    std_pack_half2x16 = 58,
    std_unpack_snorm2x16 = 60,
    std_unpack_unorm2x16 = 61,
    std_unpack_half2x16 = 62,
    std_unpack_snorm4x8 = 63,
    std_unpack_unorm4x8 = 64,
    std_find_i_lsb = 73,
    std_find_s_msb = 74,
    std_find_u_msb = 75,
    std_interpolate_at_centroid = 76,
    std_interpolate_at_offset = 78,
};

constexpr uint16_t op_memory_barrier = 225;
constexpr uint32_t capability_shader_non_uniform = 5301;
constexpr uint32_t format_r32f = 3, format_r32i = 24, format_r32ui = 33;
constexpr uint32_t operand_offset = 0x10, operand_const_offsets = 0x20;

class Finder {
public:
    Finder(const View& view, const Reflected& reflected) : v_(view), r_(reflected) {}

    Features run() {
        for (const ir::Variable& variable : v_.variables) globals_.emplace(variable.id, &variable);
        types();
        variables();
        for (const ir::Instruction& i : v_.body) instruction(i);
        for (const auto& [variable, use] : images_)
            if (use.read && use.written) written_and_read(variable);
        return out_;
    }

private:
    struct ImageUse {
        bool read = false, written = false;
    };

    void set(Feature f) { out_.used.set(static_cast<size_t>(f)); }

    void types() {
        v_.each_type([&](const ir::Type& t) {
            if (t.kind == Kind::floating && t.width == 64) set(Feature::double_precision);
            if (t.kind == Kind::integer && t.width == 64) set(Feature::int64);
            if ((t.kind == Kind::integer || t.kind == Kind::floating) && t.width < 32) set(Feature::small_numbers);
            if ((t.kind == Kind::array || t.kind == Kind::runtime_array) && v_.type(t.element).kind == Kind::array)
                set(Feature::nested_arrays);
            if (t.kind == Kind::image) image(t);
        });
        for (const uint32_t c : v_.capabilities)
            if ((c >= 61 && c <= 68) || c == 4423 || c == 4431) set(Feature::subgroups);  // GroupNonUniform*, Subgroup*KHR
        for (const uint32_t c : v_.capabilities)
            if (c == capability_shader_non_uniform) set(Feature::non_uniform);
        if (v_.invocations > 1) set(Feature::geometry_invocations);
        if (v_.imports_debug_printf) set(Feature::debug_printf);
        for (const uint32_t c : v_.capabilities)
            if (c == 5363 || c == 5372 || c == 5378) set(Feature::interlock);  // FragmentShader*InterlockEXT
        for (const uint32_t c : v_.capabilities)
            if (c == 53) set(Feature::transform_feedback);
        if (v_.early_tests) set(Feature::early_tests);
        if (v_.early_tests && r_.reflection.writes_depth) set(Feature::early_depth);
    }

    void image(const ir::Type& t) {
        const bool storage = t.sampled == 2 && t.dim != ir::dim_subpass;
        if (storage) set(Feature::storage_image);
        if (t.dim == ir::dim_cube && t.arrayed) set(storage ? Feature::cube_array_image : Feature::cube_array);
        if (t.dim == ir::dim_buffer) set(Feature::buffer_texture);
        if (t.multisampled) {
            set(t.arrayed ? Feature::multisampled_array : Feature::multisampled);
            if (storage) set(Feature::multisampled_image);
        }
    }

    void variables() {
        for (const DeclaredResource& d : r_.resources)
            if (d.resource.kind == ResourceKind::storage_block) set(Feature::storage_block);
        for (const ir::Variable& variable : v_.variables) {
            if (variable.storage != ir::sc_input && variable.storage != ir::sc_output) continue;
            const ir::Decorations& marks = v_.marks(variable.id);
            if (marks.builtin != ir::none) builtin(marks.builtin, variable.storage);
            if (marks.index != ir::none && marks.index != 0) set(Feature::dual_source);
            qualifiers(marks);
            for (uint32_t m = 0; m < v_.type(variable.type).members.size(); ++m) qualifiers(v_.member_marks(variable.type, m));
        }
    }

    void qualifiers(const ir::Decorations& marks) {
        if (marks.sample) set(Feature::per_sample_input);
        if (marks.no_perspective) set(Feature::no_perspective);
    }

    void builtin(uint32_t number, uint32_t storage) {
        const Stage stage = r_.reflection.stage;
        switch (number) {
            case ir::builtin_clip_distance:
                set(Feature::clip_distance);
                break;
            case ir::builtin_cull_distance:
                set(Feature::cull_distance);
                break;
            case ir::builtin_primitive_id:
                if (stage == Stage::fragment) set(Feature::primitive_id);
                break;
            case ir::builtin_layer:
            case ir::builtin_viewport_index:
                if (stage == Stage::fragment)
                    set(number == ir::builtin_layer ? Feature::fragment_layer : Feature::fragment_viewport);
                else if (storage == ir::sc_output && stage != Stage::geometry)
                    set(Feature::vertex_layer);
                break;
            case ir::builtin_sample_id:
            case ir::builtin_sample_position:
            case ir::builtin_sample_mask:
                set(Feature::sample_inputs);
                break;
            case ir::builtin_helper_invocation:
                set(Feature::helper_invocation);
                break;
            case ir::builtin_num_workgroups:
                set(Feature::workgroup_count);
                break;
            case ir::builtin_base_vertex:
            case ir::builtin_base_instance:
                set(Feature::draw_parameters);
                break;
            case ir::builtin_draw_index:
                set(Feature::draw_index);
                break;
            default:
                break;
        }
    }

    // Follows an access chain into a built-in block, and notes what is indexed by more than a constant.
    void chain(const ir::Instruction& i) {
        const auto known = globals_.find(v_.word(i, 3));
        if (known == globals_.end()) return;
        const ir::Variable& variable = *known->second;
        if (v_.length(i) > 4) indexed(variable, v_.word(i, 4));
        uint32_t type = variable.type;
        for (uint32_t n = 4; n < v_.length(i); ++n) {
            const ir::Type& t = v_.type(type);
            if (t.kind != Kind::structure) {
                type = t.element;
                continue;
            }
            const ir::Constant& index = v_.global(v_.word(i, n)).constant;
            if (!index.known || index.words[0] >= t.members.size()) return;
            const ir::Decorations& marks = v_.member_marks(type, index.words[0]);
            if (marks.builtin != ir::none) builtin(marks.builtin, variable.storage);
            type = t.members[index.words[0]];
        }
    }

    void indexed(const ir::Variable& variable, uint32_t index) {
        const Kind kind = v_.type(variable.type).kind;
        if (kind != Kind::array && kind != Kind::runtime_array) return;
        const ir::Constant& constant = v_.global(index).constant;
        if (constant.known && !constant.spec) return;
        if (variable.storage == ir::sc_uniform_constant) set(Feature::indexed_samplers);
        if (variable.storage == ir::sc_output && r_.reflection.stage == Stage::fragment) set(Feature::indexed_outputs);
        if (variable.storage == ir::sc_uniform || variable.storage == ir::sc_storage_buffer) set(Feature::indexed_blocks);
    }

    void extended(const ir::Instruction& i) {
        if (v_.word(i, 3) != v_.glsl_set) return;
        const uint32_t number = v_.word(i, 4);
        switch (number) {
            case std_frexp:
            case std_frexp_struct:
            case std_ldexp:
                set(Feature::frexp);
                break;
            case std_pack_snorm4x8:
            case std_pack_unorm4x8:
            case std_unpack_snorm4x8:
            case std_unpack_unorm4x8:
                set(Feature::pack_bytes);
                break;
            case std_pack_snorm2x16:
            case std_unpack_snorm2x16:
            case std_pack_unorm2x16:
            case std_unpack_unorm2x16:
                set(Feature::pack_norm16);
                break;
            case std_pack_half2x16:
            case std_unpack_half2x16:
                set(Feature::pack_half);
                break;
            case std_find_i_lsb:
            case std_find_s_msb:
            case std_find_u_msb:
                set(Feature::bit_fields);
                break;
            default:
                if (number >= std_interpolate_at_centroid && number <= std_interpolate_at_offset) set(Feature::interpolate_at);
        }
    }

    // The variable behind a loaded or addressed image, 0 when it is not seen.
    uint32_t image_of(uint32_t id) const {
        const auto known = from_.find(id);
        return known == from_.end() ? 0 : known->second;
    }

    void atomic(const ir::Instruction& i, uint32_t pointer_word, bool has_result) {
        const uint32_t image = image_of(v_.word(i, pointer_word));
        if (image != 0) images_[image] = {true, true};
        const uint32_t type = has_result ? v_.word(i, 1) : 0;
        if (v_.type(type).kind == Kind::integer && v_.type(type).width == 64) set(Feature::int64_atomics);
    }

    void instruction(const ir::Instruction& i) {
        if (i.op >= ir::op_atomic_load && i.op <= ir::op_atomic_xor) {
            const bool store = i.op == ir::op_atomic_store;
            return atomic(i, store ? 1 : 3, !store);
        }
        switch (i.op) {
            case ir::op_access_chain:
            case ir::op_in_bounds_access_chain:
                chain(i);
                forward(i);
                break;
            case ir::op_load:
            case ir::op_copy_object:
            case ir::op_image_texel_pointer:
                forward(i);
                break;
            case ir::op_ext_inst:
                extended(i);
                break;
            case op_memory_barrier:
                if (r_.reflection.stage != Stage::compute) set(Feature::memory_barrier);
                break;
            case ir::op_iadd_carry:
            case ir::op_isub_borrow:
            case ir::op_umul_extended:
            case ir::op_smul_extended:
                set(Feature::add_carry);
                break;
            case ir::op_bit_field_insert:
            case ir::op_bit_field_s_extract:
            case ir::op_bit_field_u_extract:
            case ir::op_bit_reverse:
            case ir::op_bit_count:
                set(Feature::bit_fields);
                break;
            case ir::op_image_query_levels:
                set(Feature::query_levels);
                break;
            case ir::op_image_query_samples:
                set(Feature::query_samples);
                break;
            case ir::op_image_query_size:
                if (image_of(v_.word(i, 3)) != 0 && is_storage(image_of(v_.word(i, 3)))) set(Feature::image_size);
                break;
            case ir::op_image_gather:
            case ir::op_image_dref_gather:
                if (v_.length(i) > 6 && (v_.word(i, 6) & (operand_offset | operand_const_offsets)) != 0)
                    set(Feature::gather_offsets);
                break;
            case ir::op_image_read:
                images_[image_of(v_.word(i, 3))].read = true;
                break;
            case ir::op_image_write:
                images_[image_of(v_.word(i, 1))].written = true;
                break;
            case ir::op_is_helper_invocation:
                set(Feature::helper_invocation);
                break;
            default:
                if (i.op >= ir::op_dpdx_fine && i.op <= ir::op_fwidth_coarse) set(Feature::fine_derivatives);
        }
    }

    void forward(const ir::Instruction& i) {
        const uint32_t base = v_.word(i, 3);
        if (const auto known = from_.find(base); known != from_.end())
            from_[v_.word(i, 2)] = known->second;
        else if (const auto global = globals_.find(base);
                 global != globals_.end() && global->second->storage == ir::sc_uniform_constant)
            from_[v_.word(i, 2)] = base;
    }

    const ir::Type& image_type(uint32_t variable) const {
        const auto known = globals_.find(variable);
        uint32_t type = known == globals_.end() ? 0 : known->second->type;
        while (v_.type(type).kind == Kind::array || v_.type(type).kind == Kind::runtime_array) type = v_.type(type).element;
        return v_.type(type);
    }

    bool is_storage(uint32_t variable) const {
        const ir::Type& t = image_type(variable);
        return t.kind == Kind::image && t.sampled == 2;
    }

    void written_and_read(uint32_t variable) {
        const uint32_t format = image_type(variable).format;
        if (variable == 0 || (format != format_r32f && format != format_r32i && format != format_r32ui))
            set(Feature::image_write_and_read);
    }

    const View& v_;
    const Reflected& r_;
    Features out_;
    std::unordered_map<uint32_t, const ir::Variable*> globals_;
    std::unordered_map<uint32_t, uint32_t> from_;  // value or pointer -> the resource variable behind it
    std::unordered_map<uint32_t, ImageUse> images_;
};

}  // namespace

Features find_features(const View& view, const Reflected& reflected) { return Finder(view, reflected).run(); }

}  // namespace kiln
