#pragma once
// Modules to artifacts, with slots assigned once per shader from the union of its variants.
//
// What the texts promise:
//   - Names of blocks, images and samplers are the slots' names in every variant and target (a name that is a keyword of the
//     target gets an underscore in front). Separate images and samplers become `<image>_<sampler>` in GLSL and ESSL, an image
//     that is only fetched from `<image>_fetch`. Push constants are a uniform block in GLSL and ESSL, a cbuffer in HLSL.
//     A block whose members differ between stages is `<name>_<stage>` in GLSL and ESSL (Slot::by_stage).
//   - Numbers are the slots'. GLSL 450 and ESSL 310 carry them as bindings; GLSL 330 and ESSL 300 have no bindings, there the
//     application sets them by name after linking. HLSL uses register space 0 alone.
//   - GLSL 330 and ESSL 300 link varyings by name, so one at location 3 is `io_loc3` on both sides (`io_loc3c2` from component
//     2 on). So do GLSL 450 and ESSL 310 where a shader hands over blocks or structures (SlotLayout::flat_blocks). In GLSL and
//     ESSL the writer takes over the reader's interpolation. Vertex inputs, fragment outputs and all other targets keep
//     names and locations (HLSL: TEXCOORD<location>).
//   - Clip space: GLSL and ESSL vertex texts end with the change from Vulkan's depth 0..w to -w..w. No target flips y: where
//     y points up in clip space (Metal, Direct3D) the application mirrors its projection or viewport, and in GL, where rows of
//     memory agree with Vulkan's, winding is the other way round.
//   - gl_InstanceIndex counts from the base instance in GLSL 450 (ARB_shader_draw_parameters or the uniform
//     SPIRV_Cross_BaseInstance) and MSL, from 0 in GLSL 330 and ESSL, whose draw calls have none, and in HLSL, as SV_InstanceID.

#include <array>
#include <map>

#include "compiler/modules/modules.h"

namespace kiln {

inline constexpr uint32_t no_artifact = ~0u;

struct Artifacts {
    struct Text {
        Target target = Target::glsl450;
        std::string text;
    };
    std::vector<Text> list;  // distinct per target, in order of first use
    // [shader index][target index][module index] -> artifact, or no_artifact: unused by the shader, or refused. Two shaders that
    // share a module may differ in slots, hence the first index.
    std::vector<std::vector<std::vector<uint32_t>>> of;
    std::vector<SlotLayout> slots;  // per shader
    // {shader index, target index, module index} -> why the target cannot say it: the stated holes of the table.
    std::map<std::array<uint32_t, 3>, std::string> refusals;
    Diags diags;
    uint64_t translated = 0, cache_hits = 0;  // texts and refusals that SPIRV-Cross was asked for; that the store had
    uint64_t store_failures = 0;              // gets and puts that failed; the first one is a warning
};

struct TranslateOptions {
    std::vector<Target> targets;  // spirv among them is skipped
    bool parse_back = false;
};

// The union layout of every module that a shader uses, in Vulkan's numbering and each target's. Two resources of different
// kinds at one set and binding get a slot each; whether that is allowed is for check_interfaces to say.
SlotLayout assign_slots(const std::vector<const Reflection*>& modules);

// `stages` and `modules.of_class` run in parallel; shaders are numbered by first appearance in `stages`. A refusal is a warning
// with the variants that it hits; with parse_back, a text that glslang does not accept is an error. Depends on its input
// alone: neither on threads nor on what the store holds.
Artifacts translate_modules(const std::vector<StageClasses>& stages, const Modules& modules, const TranslateOptions& options,
                            Store& store, Toolchain& tools, const Jobs& jobs, const Progress& progress,
                            Elsewhere* elsewhere = nullptr);

}  // namespace kiln
