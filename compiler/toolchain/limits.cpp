// SPIRV-Cross throws on much of what a target lacks, and that becomes a refusal by itself. This table has the rest: what it
// writes down silently although no compiler of that language version accepts it. Found by writing a shader for each feature
// and giving every text to a second front end (tests/unit/translate/limits_test.cpp).

#include "compiler/toolchain/limits.h"

#include "compiler/toolchain/edits.h"

namespace kiln {
namespace {

constexpr unsigned never = ~0U;

// The first version of each language that has a feature; 0: all of ours. `metal` and `hlsl` as in version_of().
struct Limit {
    Feature feature;
    const char* words;
    unsigned glsl, essl, hlsl, metal;
    const char* extension330 = nullptr;  // makes up for the version in that target
    const char* extension310 = nullptr;
    const char* extension450 = nullptr;  // wanted even there
};

constexpr Limit limits[] = {
    {Feature::add_carry, "uaddCarry, usubBorrow, umulExtended or imulExtended", 400, 310, never, 0},
    {Feature::double_precision, "double-precision numbers", 0, never, 0, never},
    {Feature::int64, "64-bit integers", 450, never, 60, 20200},
    {Feature::int64_atomics, "atomics on 64-bit integers", never, never, never, never},
    {Feature::small_numbers, "8-bit or 16-bit numbers", 450, never, 0, 0},
    {Feature::bit_fields, "bit-field functions", 400, 310, 0, 0},
    {Feature::frexp, "frexp or ldexp", 400, 310, 0, 0},
    {Feature::pack_bytes, "packing of 4x8 bits", 400, 310, 0, 0},
    {Feature::pack_norm16, "packing of 2x16 bits", 420, 0, 0, 0},
    {Feature::pack_half, "packHalf2x16", 420, 0, 0, 0},
    {Feature::interpolate_at, "interpolateAtCentroid, -Sample or -Offset", 400, 320, 0, 20300, nullptr,
     "GL_OES_shader_multisample_interpolation"},
    {Feature::fine_derivatives, "fine and coarse derivatives", 450, never, 0, 0},
    {Feature::query_levels, "textureQueryLevels", 430, never, 0, 0},
    {Feature::query_samples, "textureSamples", 450, never, 0, 0},
    {Feature::image_size, "imageSize", 430, 310, 0, 0},
    {Feature::image_write_and_read, "an image both read and written whose format is not r32f, r32i or r32ui", 0, never, 0, 0},
    {Feature::gather_offsets, "textureGather with an offset that varies, or with four", 400, 320, 0, 0, nullptr,
     "GL_EXT_gpu_shader5"},
    {Feature::cube_array, "cube-map arrays", 400, 320, 0, 0, "GL_ARB_texture_cube_map_array", "GL_EXT_texture_cube_map_array"},
    {Feature::cube_array_image, "images of cube-map arrays", 420, 320, never, 0, nullptr, "GL_EXT_texture_cube_map_array"},
    {Feature::multisampled, "multisampled textures", 0, 310, 0, 0},
    {Feature::multisampled_array, "multisampled array textures", 0, 320, 0, 0, nullptr,
     "GL_OES_texture_storage_multisample_2d_array"},
    {Feature::multisampled_image, "multisampled images", 420, never, never, never},
    {Feature::buffer_texture, "buffer textures", 0, 310, 0, 0},
    {Feature::storage_block, "storage blocks", 430, 310, 0, 0},
    {Feature::storage_image, "storage images", 0, 310, 0, 0},
    {Feature::early_tests, "early_fragment_tests", 420, 310, 0, 0},
    {Feature::clip_distance, "gl_ClipDistance", 0, never, 0, 0},
    {Feature::cull_distance, "gl_CullDistance", 450, never, 0, never},
    {Feature::sample_inputs, "gl_SampleID, gl_SamplePosition or gl_SampleMask", 400, 310, 0, 0},
    {Feature::fragment_layer, "gl_Layer in a fragment shader", 430, 320, never, 0, nullptr, "GL_EXT_geometry_shader"},
    {Feature::fragment_viewport, "gl_ViewportIndex in a fragment shader", 430, never, never, 0},
    {Feature::primitive_id, "gl_PrimitiveID in a fragment shader", 0, 320, 0, 0, nullptr, "GL_EXT_geometry_shader"},
    {Feature::vertex_layer, "gl_Layer or gl_ViewportIndex outside a geometry shader", 450, never, never, 0, nullptr, nullptr,
     "GL_ARB_shader_viewport_layer_array"},
    {Feature::draw_parameters, "gl_BaseVertex or gl_BaseInstance", 450, never, never, 0},
    {Feature::draw_index, "gl_DrawID", 450, never, never, never},
    {Feature::helper_invocation, "gl_HelperInvocation", 450, 310, never, 20100},
    {Feature::workgroup_count, "gl_NumWorkGroups", 430, 310, never, 0},
    {Feature::dual_source, "a second blend source", 0, never, 0, 0},
    {Feature::per_sample_input, "the sample qualifier", 400, 320, 0, 0, nullptr, "GL_OES_shader_multisample_interpolation"},
    {Feature::no_perspective, "the noperspective qualifier", 0, never, 0, 0},
    {Feature::nested_arrays, "arrays of arrays", 430, 310, 0, 0},
    {Feature::indexed_samplers, "arrays of samplers or images with an index that is no constant", 400, 320, 0, 0, nullptr,
     "GL_EXT_gpu_shader5"},
    {Feature::indexed_blocks, "arrays of blocks with an index that is no constant", 400, 320, 0, 0},
    {Feature::subgroups, "subgroup operations", 450, never, 60, 0},
    {Feature::debug_printf, "debugPrintfEXT", never, never, never, never},
    {Feature::geometry_invocations, "several invocations of a geometry shader", 400, 0, 0, 0},
    {Feature::non_uniform, "nonuniformEXT", never, never, 0, 0},
    {Feature::interlock, "a fragment shader interlock", 450, never, 0, 0},
    {Feature::early_depth, "gl_FragDepth together with early_fragment_tests", 0, never, 0, 0},
    {Feature::indexed_outputs, "an array of fragment outputs with an index that is no constant", 0, never, 0, 0},
    {Feature::memory_barrier, "barriers of memory outside compute shaders", 420, 310, never, never},
    {Feature::transform_feedback, "layouts of transform feedback", 440, 0, 0, 0},
};

// Which stages we can hand over in a language as it is. Metal's and HLSL's geometry and tessellation stages are shaped
// differently, and SPIRV-Cross either refuses them or writes what needs a host side of its own.
bool has_stage(Stage stage, Target target) {
    switch (stage) {
        case Stage::vertex:
        case Stage::fragment:
            return true;
        case Stage::compute:
            return target != Target::glsl330 && target != Target::essl300;
        case Stage::geometry:
        case Stage::tess_control:
        case Stage::tess_evaluation:
            return target == Target::glsl330 || target == Target::glsl450 || target == Target::essl310;
        default:
            return false;
    }
}

const char* extension_for(const Limit& l, Target target) {
    switch (target) {
        case Target::glsl330:
            return l.extension330;
        case Target::glsl450:
            return l.extension450;
        case Target::essl310:
            return l.extension310;
        default:
            return nullptr;
    }
}

unsigned first_version(const Limit& l, Target target) {
    switch (language_of(target)) {
        case Language::glsl:
            return l.glsl;
        case Language::essl:
            return l.essl;
        case Language::hlsl:
            return l.hlsl;
        case Language::msl:
            return l.metal;
    }
    return never;
}

std::string language_words(Target target, unsigned version) {
    const auto dotted = [](unsigned major, unsigned minor) { return std::to_string(major) + "." + std::to_string(minor); };
    switch (language_of(target)) {
        case Language::glsl:
            return "GLSL " + dotted(version / 100, version / 10 % 10) + "0";
        case Language::essl:
            return "ESSL " + dotted(version / 100, version / 10 % 10) + "0";
        case Language::hlsl:
            return "shader model " + dotted(version / 10, version % 10);
        case Language::msl:
            return "MSL " + dotted(version / 10000, version / 100 % 100);
    }
    return {};
}

const char* language_name(Target target) {
    switch (language_of(target)) {
        case Language::glsl:
            return "GLSL";
        case Language::essl:
            return "ESSL";
        case Language::hlsl:
            return "HLSL";
        case Language::msl:
            return "Metal";
    }
    return "";
}

}  // namespace

std::string target_limit(const Features& features, Stage stage, Target target) {
    if (!has_stage(stage, target))
        return language_words(target, version_of(target)) + " has no " + name_of(stage) + " stage that kiln can write";
    for (const Limit& l : limits) {
        if (!features.has(l.feature)) continue;
        const unsigned first = first_version(l, target);
        if (first == never) return std::string(l.words) + ": not in " + language_name(target);
        if (version_of(target) < first && !extension_for(l, target))
            return std::string(l.words) + ": not before " + language_words(target, first);
    }
    return {};
}

std::vector<const char*> target_extensions(const Features& features, Target target) {
    std::vector<const char*> out;
    for (const Limit& l : limits)
        if (features.has(l.feature) && extension_for(l, target)) out.push_back(extension_for(l, target));
    return out;
}

}  // namespace kiln
