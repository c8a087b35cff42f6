#pragma once
// What does not fit between two stages of one pipeline, from their reflections alone.

#include <string>
#include <vector>

#include "compiler/base/diag.h"
#include "compiler/reflect/reflect.h"

namespace kiln {

struct Mismatch {
    Severity severity = Severity::error;
    std::string message;
    friend auto operator<=>(const Mismatch&, const Mismatch&) = default;
};

// Outputs of a stage against inputs of the next one, by location and component as Vulkan matches them: everything that is
// read must be written with the same kind of number. More written than read is fine; interpolation is the reader's business.
// A vector that is written with more components than are read is a warning: it takes VK_KHR_maintenance4 and no GL links it.
std::vector<Mismatch> match_varyings(const Reflection& writer, const Reflection& reader);

// Two varyings of one stage in the same place.
std::vector<Mismatch> overlapping_varyings(const Reflection& stage);

// Resources at the same set and binding that are not the same thing; push constants that overlap with another meaning.
std::vector<Mismatch> match_resources(const Reflection& a, const Reflection& b);

std::string type_name(const ValueType& type);                         // "vec3", "mat4x3[2]"
std::string resource_words(const Resource& resource);                 // "uniform block 'Scene'"
std::string resource_place(const Resource& resource);                 // "set 0, binding 1"; "push constants"
std::string image_words(const Resource& resource);                    // "sampler2DShadow", "imageBuffer"; empty for blocks
std::string member_difference(const Resource& a, const Resource& b);  // the first common member that moved or changed, or empty

}  // namespace kiln
