#pragma once
// A SPIR-V module read once into plain tables: types, constants, variables, decorations, names, the entry point, and
// which instructions its functions use. Reading needs no library and costs microseconds, so that reflection of thousands
// of modules, warm builds included, is never the thing one waits for.
//
// Refuses (an input Error) whatever is not well-formed enough to be walked safely: bad magic, an instruction that runs
// past the end, an id out of bounds, a type used before it is defined, nesting deeper than `max_depth`, no entry point or
// more than one. It does not replace spirv-val.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln::ir {

inline constexpr unsigned max_depth = 64;        // of nested types
inline constexpr uint32_t max_bound = 0x3fffff;  // ids, the universal limit of the SPIR-V specification
inline constexpr uint32_t none = ~0u;

enum class Kind : uint8_t {
    other,
    void_,
    boolean,
    integer,
    floating,
    vector,
    matrix,
    array,
    runtime_array,
    structure,
    pointer,
    image,
    sampler,
    sampled_image,
    acceleration_structure,
};

struct Type {
    Kind kind = Kind::other;
    uint32_t element = 0;  // of a vector, matrix (its column), array, pointer; an image's sampled type; a sampled image's image
    uint32_t count = 0;    // components, columns, array length; a pointer's storage class
    bool spec_sized = false;  // an array whose length is a specialisation constant (its default is `count`)
    uint32_t width = 0;       // bits of a number
    bool is_signed = false;
    std::vector<uint32_t> members;
    uint32_t dim = 0, depth = 0, sampled = 0, format = 0;  // of an image, SPIR-V's numbers
    bool arrayed = false, multisampled = false;
};

struct Variable {
    uint32_t id = 0, pointer_type = 0, type = 0;  // `type` is what the pointer points to
    uint32_t storage = 0;                         // SPIR-V's storage class
};

// Decorations that matter here. A number is `none` where the decoration is absent.
struct Decorations {
    uint32_t location = none, component = none, index = none, binding = none, set = none, offset = none, builtin = none;
    uint32_t array_stride = none, matrix_stride = none, input_attachment = none, spec_id = none;
    bool block = false, buffer_block = false, row_major = false, flat = false, no_perspective = false, centroid = false,
         sample = false, patch = false, per_vertex = false, non_writable = false, non_readable = false, relaxed = false;
};

struct Constant {
    uint32_t type = 0;
    std::vector<uint32_t> words;  // literal words, or ids of a composite's parts
    bool known = false;           // an integer whose value is words[0]
    bool spec = false;
};

struct Instruction {
    uint16_t op = 0;
    uint32_t at = 0;  // index of its first word
};

// All that is known about one id at module scope.
struct Global {
    Type type;
    Decorations marks;
    Constant constant;
    std::string name;
    std::vector<Decorations> member_marks;  // of a structure
    std::vector<std::string> member_names;
};

class View {
public:
    WordView words;  // the caller's; must outlive the view
    uint32_t version = 0, bound = 0;
    uint32_t model = 0, entry_id = 0;  // SPIR-V's execution model
    std::string entry;
    std::vector<uint32_t> interface;
    std::vector<uint32_t> capabilities;
    std::vector<std::string> extensions;
    uint32_t glsl_set = 0;  // id of the GLSL.std.450 import, 0 when absent
    std::array<uint32_t, 3> workgroup{0, 0, 0};
    uint32_t invocations = 1;  // of a geometry shader
    bool depth_replacing = false, early_tests = false;
    bool imports_debug_printf = false;
    std::vector<Variable> variables;  // at module scope, in order
    std::vector<Instruction> body;    // every instruction from the first OpFunction on

    // An id that means nothing, or is out of bounds, gives the empty record.
    const Global& global(uint32_t id) const { return globals_[id < slots_.size() ? slots_[id] : 0]; }
    const Type& type(uint32_t id) const { return global(id).type; }
    const Decorations& marks(uint32_t id) const { return global(id).marks; }
    const Decorations& member_marks(uint32_t type_id, uint32_t member) const;
    const std::string& name(uint32_t id) const { return global(id).name; }
    const std::string& member_name(uint32_t type_id, uint32_t member) const;
    uint32_t word(const Instruction& i, uint32_t n) const { return n < length(i) ? words[i.at + n] : 0; }
    uint32_t length(const Instruction& i) const { return words[i.at] >> 16; }
    template <class Visit>
    void each_type(const Visit& visit) const {
        for (const Global& g : globals_)
            if (g.type.kind != Kind::other) visit(g.type);
    }

private:
    friend class Reader;
    std::vector<uint32_t> slots_;  // id -> index into globals_; 0: nothing known
    std::vector<Global> globals_{1};
};

Result<View> read_view(WordView words);

}  // namespace kiln::ir
