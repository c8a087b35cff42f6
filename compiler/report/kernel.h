#pragma once
// The compute shaders that render and time a member, as text and as SPIR-V.

#include "compiler/base/files.h"
#include "compiler/report/family.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln::report {

// GLSL of uber/lib, found by the name in #include "…". Every file is read once and given once a text.
class Library {
public:
    Library(Files& files, std::string folder) : files_(files), folder_(std::move(folder)) {}
    // `text` with its includes replaced. Input error: a file is missing.
    Result<std::string> expanded(const std::string& text);

private:
    Status append(std::string& out, const std::string& text, std::vector<std::string>& given);
    Files& files_;
    std::string folder_;
    std::map<std::string, std::string> known_;
};

enum class Job : uint8_t {
    points,   // point_at of every pixel
    picture,  // shade of every point that was stored
    timing,   // a loop over shade(point_at(…)), and the sum of the points' numbers
    baseline  // the same loop without shade
};

// Push constants of all of them: uvec4(width, height, repeats, seed). Bindings of set 0: 0 results (floats), 1 points (floats;
// picture only), then `resources` in order.
std::string kernel_text(Job job, const std::vector<Field>& fields, const std::vector<Resource>& resources,
                        const std::string& scene, const std::string& member);

// A bake: results[4 i …] = texel(i), i < width * height of the draw, with texel given by `functions`: vec4 texel(uint i).
std::string bake_text(const std::vector<Resource>& resources, const std::string& functions);

inline constexpr uint32_t group_size = 64;

struct Kernel {
    StageCode code;
    uint64_t bytes = 0;       // of SPIR-V
    uint64_t operations = 0;  // instructions inside functions, but for labels, variables and the function's own frame
};

// Compiled and optimised as a build does it. An input error holds the compiler's messages and the text's line.
Result<Kernel> compile_kernel(const std::string& text, Toolchain& tools);

uint64_t count_operations(WordView words);

size_t floats_of(const std::vector<Field>& fields);

}  // namespace kiln::report
