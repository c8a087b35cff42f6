#pragma once
// What has to be said to SPIRV-Cross about one module before it writes one target: stable names and numbers. Worked out
// here in our own types; cross.cpp only passes it on.

#include <string>
#include <utility>
#include <vector>

#include "compiler/reflect/module_resources.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

enum class Language : uint8_t { glsl, essl, hlsl, msl };
Language language_of(Target target);  // not for spirv
unsigned version_of(Target target);   // 330, 310, 50 (shader model 5.0), 20100 (MSL 2.1)
bool links_by_name(Target target);    // varyings have no locations in its texts
bool has_bindings(Target target);     // its texts carry binding numbers

struct Edits {
    std::vector<std::pair<uint32_t, std::string>> names;  // id -> name
    struct MemberName {
        uint32_t type = 0, member = 0;
        std::string name;
    };
    std::vector<MemberName> member_names;
    std::vector<std::pair<uint32_t, uint32_t>> bindings;  // variable -> number, for GLSL and ESSL
    // Variables, or members of a structure, whose interpolation is set to this.
    struct Interpolate {
        uint32_t id = 0;
        bool is_member = false;
        uint32_t member = 0;
        Interpolation how;
    };
    std::vector<Interpolate> interpolate;
    std::vector<Slot> slots;         // of this module's resources, for HLSL and MSL
    std::vector<uint32_t> unplaced;  // variables that lose their location
    std::vector<std::pair<uint32_t, Slot>> by_variable;
    std::vector<const char*> extensions;  // to be asked for
    bool separate = false;                // has images or samplers that are not combined

    const Slot* slot_of(uint32_t variable) const;  // nullptr: none
};

// An Error when a resource has no slot in `layout`.
Result<Edits> plan_edits(const ir::View& view, const Reflected& reflected, Target target, const SlotLayout& layout);

// The slot of a resource, or nullptr.
const Slot* find_slot(const SlotLayout& layout, const Resource& resource);

}  // namespace kiln
