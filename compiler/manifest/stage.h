#pragma once
// Shader stages and output languages, as they are named in manifests, on the command line and on disk.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace kiln {

enum class Stage : uint8_t {  // on disk: append only
    vertex = 0,
    tess_control = 1,
    tess_evaluation = 2,
    geometry = 3,
    fragment = 4,
    compute = 5,
    task = 6,
    mesh = 7,
    raygen = 8,
    intersection = 9,
    any_hit = 10,
    closest_hit = 11,
    miss = 12,
    callable = 13,
};
inline constexpr unsigned stage_count = 14;

enum class Target : uint8_t {  // on disk: append only
    spirv = 0,
    glsl330 = 1,
    glsl450 = 2,
    essl300 = 3,
    essl310 = 4,
    hlsl50 = 5,
    hlsl60 = 6,
    msl21 = 7,
    msl22 = 8,
    msl23 = 9,
    msl24 = 10,
    msl30 = 11,
};
inline constexpr unsigned target_count = 12;

const char* name_of(Stage stage);    // "vertex"
const char* name_of(Target target);  // "essl310"
std::optional<Stage> stage_named(std::string_view name);
std::optional<Target> target_named(std::string_view name);
std::vector<Stage> all_stages();
std::vector<Target> all_targets();

}  // namespace kiln
