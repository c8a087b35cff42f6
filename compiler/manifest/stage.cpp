#include "compiler/manifest/stage.h"

namespace kiln {

namespace {
constexpr const char* stage_names[stage_count] = {
    "vertex", "tess_control", "tess_evaluation", "geometry", "fragment",    "compute", "task",
    "mesh",   "raygen",       "intersection",    "any_hit",  "closest_hit", "miss",    "callable"};
constexpr const char* target_names[target_count] = {"spirv",  "glsl330", "glsl450", "essl300", "essl310", "hlsl50",
                                                    "hlsl60", "msl21",   "msl22",   "msl23",   "msl24",   "msl30"};
}  // namespace

const char* name_of(Stage stage) { return stage_names[static_cast<unsigned>(stage)]; }
const char* name_of(Target target) { return target_names[static_cast<unsigned>(target)]; }

std::optional<Stage> stage_named(std::string_view name) {
    for (const Stage s : all_stages())
        if (name == name_of(s)) return s;
    return std::nullopt;
}

std::optional<Target> target_named(std::string_view name) {
    for (const Target t : all_targets())
        if (name == name_of(t)) return t;
    return std::nullopt;
}

std::vector<Stage> all_stages() {
    std::vector<Stage> out;
    for (unsigned i = 0; i < stage_count; ++i) out.push_back(static_cast<Stage>(i));
    return out;
}

std::vector<Target> all_targets() {
    std::vector<Target> out;
    for (unsigned i = 0; i < target_count; ++i) out.push_back(static_cast<Target>(i));
    return out;
}

}  // namespace kiln
