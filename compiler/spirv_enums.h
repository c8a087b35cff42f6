#pragma once
// The numbers of the SPIR-V specification that this project looks at, by their names there.

#include <cstdint>

namespace kiln::ir {

inline constexpr uint32_t magic = 0x07230203;

enum Opcode : uint16_t {
    op_name = 5,
    op_member_name = 6,
    op_extension = 10,
    op_ext_inst_import = 11,
    op_ext_inst = 12,
    op_entry_point = 15,
    op_execution_mode = 16,
    op_capability = 17,
    op_type_void = 19,
    op_type_bool = 20,
    op_type_int = 21,
    op_type_float = 22,
    op_type_vector = 23,
    op_type_matrix = 24,
    op_type_image = 25,
    op_type_sampler = 26,
    op_type_sampled_image = 27,
    op_type_array = 28,
    op_type_runtime_array = 29,
    op_type_struct = 30,
    op_type_pointer = 32,
    op_constant_true = 41,
    op_constant_false = 42,
    op_constant = 43,
    op_constant_composite = 44,
    op_spec_constant_true = 48,
    op_spec_constant_false = 49,
    op_spec_constant = 50,
    op_spec_constant_composite = 51,
    op_spec_constant_op = 52,
    op_function = 54,
    op_function_call = 57,
    op_variable = 59,
    op_image_texel_pointer = 60,
    op_load = 61,
    op_store = 62,
    op_access_chain = 65,
    op_in_bounds_access_chain = 66,
    op_array_length = 68,
    op_decorate = 71,
    op_member_decorate = 72,
    op_copy_object = 83,
    op_sampled_image = 86,
    op_image_sample_implicit_lod = 87,
    op_image_sample_explicit_lod = 88,
    op_image_sample_dref_implicit_lod = 89,
    op_image_sample_dref_explicit_lod = 90,
    op_image_sample_proj_implicit_lod = 91,
    op_image_sample_proj_explicit_lod = 92,
    op_image_sample_proj_dref_implicit_lod = 93,
    op_image_sample_proj_dref_explicit_lod = 94,
    op_image_fetch = 95,
    op_image_gather = 96,
    op_image_dref_gather = 97,
    op_image_read = 98,
    op_image_write = 99,
    op_image = 100,
    op_image_query_size_lod = 103,
    op_image_query_size = 104,
    op_image_query_lod = 105,
    op_image_query_levels = 106,
    op_image_query_samples = 107,
    op_iadd_carry = 149,
    op_isub_borrow = 150,
    op_umul_extended = 151,
    op_smul_extended = 152,
    op_bit_field_insert = 201,
    op_bit_field_s_extract = 202,
    op_bit_field_u_extract = 203,
    op_bit_reverse = 204,
    op_bit_count = 205,
    op_kill = 252,
    op_terminate_invocation = 4416,
    op_type_acceleration_structure = 5341,
    op_demote = 5380,
};

enum Decoration : uint32_t {
    dec_relaxed = 0,
    dec_spec_id = 1,
    dec_block = 2,
    dec_buffer_block = 3,
    dec_row_major = 4,
    dec_array_stride = 6,
    dec_matrix_stride = 7,
    dec_builtin = 11,
    dec_no_perspective = 13,
    dec_flat = 14,
    dec_patch = 15,
    dec_centroid = 16,
    dec_sample = 17,
    dec_non_writable = 24,
    dec_non_readable = 25,
    dec_location = 30,
    dec_component = 31,
    dec_index = 32,
    dec_binding = 33,
    dec_descriptor_set = 34,
    dec_offset = 35,
    dec_input_attachment_index = 43,
};

enum StorageClass : uint32_t {
    sc_uniform_constant = 0,
    sc_input = 1,
    sc_uniform = 2,
    sc_output = 3,
    sc_push_constant = 9,
    sc_storage_buffer = 12,
};

enum ExecutionMode : uint32_t { mode_depth_replacing = 12, mode_local_size = 17 };

enum BuiltIn : uint32_t { builtin_workgroup_size = 25 };

enum Dim : uint32_t { dim_1d = 0, dim_2d = 1, dim_3d = 2, dim_cube = 3, dim_rect = 4, dim_buffer = 5, dim_subpass = 6 };

}  // namespace kiln::ir
