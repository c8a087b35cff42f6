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
#include "compiler/manifest.h"
#include "compiler/reflect.h"

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

// Where each resource of a shader lives in each target, assigned once from the union of its variants.
struct Slot {
    ResourceKind kind = ResourceKind::uniform_block;
    uint32_t set = 0, binding = 0;  // Vulkan's, the key
    std::string name;
    uint32_t buffer = 0, texture = 0, sampler = 0,
             image = 0;  // numbers in the target's spaces: GL binding, HLSL b/t/s/u, MSL index
};

struct SlotLayout {
    std::vector<Slot> slots;  // by set, binding; push constants last with set = binding = ~0u
    friend bool operator==(const SlotLayout&, const SlotLayout&) = default;
};
inline bool operator==(const Slot& a, const Slot& b) {
    return a.kind == b.kind && a.set == b.set && a.binding == b.binding && a.name == b.name && a.buffer == b.buffer &&
           a.texture == b.texture && a.sampler == b.sampler && a.image == b.image;
}

// A text, or why the target cannot say it.
struct Translated {
    std::string text;  // empty when refused
    std::string refusal;
};

class Toolchain {
public:
    virtual ~Toolchain() = default;
    virtual std::string versions()
        const = 0;  // every tool and its version, for cache keys and the table. Must not initialise glslang

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
