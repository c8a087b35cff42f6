#pragma once
// What a target cannot say although SPIRV-Cross would write something: found in the module's instructions and types, not in
// the text. Looked up in one table of language features with the first version of each language that has them.

#include <bitset>
#include <string>
#include <vector>

#include "compiler/manifest/stage.h"
#include "compiler/reflect/module_resources.h"

namespace kiln {

enum class Feature : uint8_t {
    add_carry,
    double_precision,
    int64,
    int64_atomics,
    small_numbers,
    bit_fields,
    frexp,
    pack_bytes,
    pack_norm16,
    pack_half,
    interpolate_at,
    fine_derivatives,
    query_levels,
    query_samples,
    image_size,
    image_write_and_read,
    gather_offsets,
    cube_array,
    cube_array_image,
    multisampled,
    multisampled_array,
    multisampled_image,
    buffer_texture,
    storage_block,
    storage_image,
    early_tests,
    clip_distance,
    cull_distance,
    sample_inputs,
    fragment_layer,
    fragment_viewport,
    primitive_id,
    vertex_layer,
    draw_parameters,
    draw_index,
    helper_invocation,
    workgroup_count,
    dual_source,
    per_sample_input,
    no_perspective,
    nested_arrays,
    indexed_samplers,
    indexed_blocks,
    subgroups,
    debug_printf,
    geometry_invocations,
    non_uniform,
    interlock,
    early_depth,
    indexed_outputs,
    memory_barrier,
    transform_feedback,
    count_
};

struct Features {
    std::bitset<static_cast<size_t>(Feature::count_)> used;
    bool has(Feature f) const { return used[static_cast<size_t>(f)]; }
};

Features find_features(const ir::View& view, const Reflected& reflected);

// Why `target` cannot say a module of this stage with these features; empty when nothing is known against it.
std::string target_limit(const Features& features, Stage stage, Target target);

// Extensions that the text has to ask for and SPIRV-Cross does not.
std::vector<const char*> target_extensions(const Features& features, Target target);

}  // namespace kiln
