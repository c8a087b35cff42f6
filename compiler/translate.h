#pragma once
// Modules to artifacts, with slots assigned once per shader from the union of its variants.

#include <array>
#include <map>

#include "compiler/modules.h"

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
    uint64_t translated = 0, cache_hits = 0;
};

struct TranslateOptions {
    std::vector<Target> targets;  // spirv among them is skipped
    bool parse_back = false;
};

// The union layout of every module that a shader uses, in Vulkan's numbering and each target's.
SlotLayout assign_slots(const std::vector<const Reflection*>& modules);

// `stages` and `modules.of_class` run in parallel; shaders are numbered by first appearance in `stages`.
Artifacts translate_modules(const std::vector<StageClasses>& stages, const Modules& modules, const TranslateOptions& options,
                            Store& store, Toolchain& tools, const Jobs& jobs, const Progress& progress);

}  // namespace kiln
