#pragma once
// The seam to glslang, SPIRV-Tools and SPIRV-Cross. The real one is built from one source file per library; a fake lets the
// whole pass run in a unit test. Every call may come from several threads at once.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/diag.h"
#include "compiler/base/result.h"
#include "compiler/manifest/manifest.h"
#include "compiler/reflect/reflect.h"

namespace kiln {

struct ToolMessage {
    Severity severity = Severity::error;
    uint32_t line = 0;  // in the text handed over, from 1; 0: none
    std::string text;
};

struct Compiled {
    Words words;  // empty when it failed
    std::vector<ToolMessage> messages;
};

// Where each resource of a shader lives in each target, assigned once from the union of its variants
// (compiler/translate/slots.cpp). An array takes as many consecutive numbers as it has elements. Numbers that a kind does not use
// are 0.
struct Slot {
    ResourceKind kind = ResourceKind::uniform_block;
    uint32_t set = 0, binding = 0;  // Vulkan's, the key together with kind
    std::string name;               // distinct within the layout
    uint32_t buffer = 0;            // GL uniform-block binding and HLSL b; of a storage block: GL storage-block binding
    uint32_t texture = 0;           // GL texture unit and HLSL t; of a read-only storage block: HLSL t
    uint32_t sampler = 0;           // HLSL s and Metal [[sampler]]
    uint32_t image = 0;             // GL image unit
    uint32_t uav = 0;               // HLSL u of storage blocks, images and texels
    uint32_t metal_buffer = 0;      // Metal [[buffer]]
    uint32_t metal_texture = 0;     // Metal [[texture]]
    // GL has no separate samplers: image and sampler together take the unit image.texture + sampler.unit_offset, and an image
    // that is only fetched image.texture + image.unit_offset.
    uint32_t unit_offset = 0;
    // A block whose members are not the same in all stages: GL links blocks by name and would refuse, so GLSL and ESSL texts
    // call it <name>_<stage>.
    bool by_stage = false;
    friend bool operator==(const Slot&, const Slot&) = default;
};

// How the fragment stage reads a location. Vulkan looks at the reader alone; GL wants both sides to agree.
struct Interpolation {
    uint32_t location = 0;
    bool flat = false, no_perspective = false, centroid = false, sample = false;
    friend bool operator==(const Interpolation&, const Interpolation&) = default;
};

struct SlotLayout {
    std::vector<Slot> slots;                   // by set, binding, kind; push constants last with set = binding = ~0u
    std::vector<Interpolation> interpolation;  // by location, where all fragment modules that read it agree
    // Some stage hands over a block or a structure. SPIRV-Cross flattens those for GL, which loses their locations, so all
    // varyings of the shader go by name then, in every GL target.
    bool flat_blocks = false;
    Stage rasterised = Stage::vertex;  // the shader's last stage before the rasteriser: in GL it converts depth
    friend bool operator==(const SlotLayout&, const SlotLayout&) = default;
};

// A text, or why the target cannot say it.
struct Translated {
    std::string text;  // empty when refused
    std::string refusal;
};

class Toolchain {
public:
    virtual ~Toolchain() = default;
    virtual std::string versions() const = 0;  // every tool and its version, for the table. Must not initialise glslang
    // For cache keys: versions(), and whatever else decides what the following return.
    virtual std::string identity() const { return versions(); }

    // GLSL tokens to unoptimised SPIR-V. `options.debug` keeps source names and lines.
    virtual Compiled compile(Stage stage, std::string_view text, const Options& options) = 0;
    // Removes dead functions, globals and branches and inner names, compacts ids. Interface names stay.
    virtual Result<Words> prune(WordView words, const Options& options) = 0;
    virtual Result<Words> optimise(WordView words, const Options& options) = 0;
    virtual std::vector<ToolMessage> validate(WordView words, const Options& options) = 0;

    virtual Result<Reflection> reflect(WordView words) = 0;
    // One module into several targets, parsing it once; results in the order of `targets` (spirv is not one of them).
    virtual std::vector<Translated> translate(WordView words, const std::vector<Target>& targets, const SlotLayout& slots) = 0;
    // Parses an emitted GLSL or ESSL text again; error messages, empty when it parses.
    virtual std::vector<ToolMessage> parse_back(Target target, Stage stage, std::string_view text) = 0;
    // Links a vertex and a fragment text of one GLSL or ESSL target, as a driver would; error messages, empty when they link.
    virtual std::vector<ToolMessage> link_back(Target target, std::string_view vertex, std::string_view fragment) = 0;
};

std::unique_ptr<Toolchain> make_toolchain();

}  // namespace kiln
