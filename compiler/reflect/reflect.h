#pragma once
// What a module asks of its surroundings, in our own types. Everything that the module declares is listed, as Vulkan
// counts it; built-in inputs and outputs are not.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"
#include "compiler/manifest/stage.h"

namespace kiln {

enum class ResourceKind : uint8_t {  // on disk: append only
    uniform_block = 0,
    storage_block = 1,
    combined_image = 2,
    separate_image = 3,
    separate_sampler = 4,
    storage_image = 5,
    uniform_texels = 6,
    storage_texels = 7,
    input_attachment = 8,
    acceleration_structure = 9,
    push_constants = 10,
};

enum class BaseType : uint8_t {  // on disk: append only
    float32 = 0,
    float16 = 1,
    float64 = 2,
    int32 = 3,
    uint32 = 4,
    int16 = 5,
    uint16 = 6,
    int64 = 7,
    uint64 = 8,
    boolean = 9,
    int8 = 10,
    uint8 = 11,
    structure = 12,
};

enum class ImageDim : uint8_t {
    none = 0,
    d1 = 1,
    d2 = 2,
    d3 = 3,
    cube = 4,
    rect = 5,
    buffer = 6,
    subpass = 7
};  // on disk: append only

struct ValueType {
    BaseType base = BaseType::float32;
    uint8_t rows = 1;  // components of a vector, or of a matrix column
    uint8_t columns = 1;
    std::vector<uint32_t> array;  // outermost first; 0: sized at run time
    friend bool operator==(const ValueType&, const ValueType&) = default;
};

struct Member {
    std::string name;               // nested structures are flattened: "lights[0].position" has name "lights[].position"
    ValueType type;                 // its array dimensions include those of every enclosing array: lights[4] of w[3] is {4, 3}
    uint32_t offset = 0;            // bytes from the start of the block
    uint32_t size = 0;              // bytes in one element of the innermost array of structures; 0 for a run-time array
    uint32_t array_stride = 0;      // of the innermost enclosing array, 0 when none
    std::vector<uint32_t> strides;  // bytes, one per dimension of type.array, outermost first
    uint32_t matrix_stride = 0;
    bool row_major = false;
    friend bool operator==(const Member&, const Member&) = default;
};

struct Resource {
    std::string name;  // block name, or the variable's for images and samplers
    ResourceKind kind = ResourceKind::uniform_block;
    uint32_t set = 0, binding = 0;  // unused by push constants
    std::vector<uint32_t> array;    // as in ValueType
    uint32_t bytes = 0;             // declared size of a block, without its run-time array
    std::vector<Member> members;
    ImageDim dim = ImageDim::none;
    bool arrayed = false, multisampled = false, depth = false;  // depth: used with a comparison sampler
    bool readonly = false, writeonly = false;                   // of storage blocks and images: every member says so
    BaseType sampled = BaseType::float32;
    uint32_t format = 0;  // SPIR-V ImageFormat of a storage image
    friend bool operator==(const Resource&, const Resource&) = default;
};

struct Varying {
    std::string name;
    uint32_t location = 0, component = 0, index = 0;
    // Members of interface blocks and structures are varyings of their own ("Block.member"). The array of vertices around
    // per-vertex inputs and outputs of tessellation and geometry stages is left out.
    ValueType type;
    bool flat = false, no_perspective = false, centroid = false, sample = false, patch = false;
    friend bool operator==(const Varying&, const Varying&) = default;
};

struct Reflection {
    Stage stage = Stage::vertex;
    std::string entry = "main";
    std::vector<Resource> resources;             // by set, binding, kind, name; push constants last
    std::vector<Varying> inputs, outputs;        // user-defined ones, by location, component
    std::array<uint32_t, 3> workgroup{0, 0, 0};  // 0 for stages that have none; a specialisable size by its default
    bool writes_depth = false, discards = false;
    friend bool operator==(const Reflection&, const Reflection&) = default;
};

// What the module declares: a walk over the words, some microseconds, from any thread. An input Error when the words cannot be
// walked safely or do not have exactly one entry point.
Result<Reflection> reflect_words(WordView words);

}  // namespace kiln
