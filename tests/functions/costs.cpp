#include "tests/functions/costs.h"

#include <algorithm>
#include <bit>

#include "compiler/base/files.h"
#include "compiler/report/device_bench.h"
#include "compiler/report/report.h"
#include "tests/functions/samples.h"

namespace kiln::test {

namespace {

constexpr uint32_t sets = 4096, same = 8, groups = 16;
constexpr unsigned repeats = 30;
constexpr double least_ms = 2.0;

struct Opened {
    DiskFiles files;
    report::Library library{files, std::string(KILN_SOURCE_DIR) + "/uber/lib"};
    std::unique_ptr<Toolchain> tools = make_toolchain();
    Result<std::unique_ptr<report::Bench>> bench = report::open_device_bench({}, *tools, library);
};

Opened& opened() {
    static Opened the;
    return the;
}

std::vector<report::Resource> resources_of(const CostShader& shader) {
    std::vector<report::Resource> out;
    for (size_t i = 0; i < shader.images.size(); ++i) {
        report::Resource& r = out.emplace_back();
        r.binding.kind = ResourceKind::combined_image;
        r.binding.name = shader.images[i].name;
        r.binding.images = {shader.images[i].image};
        r.binding.compare = shader.comparing[i];
        r.binding.sampler = shader.images[i].sampler;
    }
    return out;
}

// Word after word of all sets, so that neighbouring lanes read neighbouring words.
std::vector<float> arguments_of(const FunctionTest& function) {
    const std::vector<uint32_t> samples = random_arguments(function);
    const size_t known = function.words == 0 ? 0 : samples.size() / function.words;
    std::vector<float> out(size_t{sets} * function.words);
    for (size_t s = 0; s < sets && known != 0; ++s)
        for (size_t w = 0; w < function.words; ++w)
            out[w * sets + s] = std::bit_cast<float>(samples[(s % known) * function.words + w]);
    return out;
}

Result<report::Timing> time_loop(const FunctionTest& function, const CostShader& shader, const std::vector<float>& arguments,
                                 double empty_ns, bool baseline) {
    Opened& device = opened();
    if (!device.bench.ok()) return device.bench.error();
    const auto kernel = report::compile_kernel(cost_text(function, shader, baseline), *device.tools);
    KILN_TRY(kernel);
    report::Draw draw;
    draw.groups = groups;
    draw.results = size_t{groups} * report::group_size;
    if (!arguments.empty()) draw.points = &arguments;
    const auto timed = (*device.bench)->time(*kernel, resources_of(shader), draw, repeats, least_ms);
    KILN_TRY(timed);
    return report::times_of(*timed, empty_ns, double{report::group_size} * draw.groups * draw.loops * same);
}

}  // namespace

bool& costs_wanted() {
    static bool wanted = false;
    return wanted;
}

std::string cost_text(const FunctionTest& function, const CostShader& shader, bool baseline) {
    const std::string words = std::to_string(std::max(1u, function.words));
    std::string t = shader.functions;
    t += "layout(local_size_x = " + std::to_string(report::group_size) +
         ") in;\n"
         "layout(push_constant) uniform KilnDraw { uvec4 kiln_draw; };\n"
         "layout(std430, set = 0, binding = 0) buffer KilnResults { float kiln_results[]; };\n"
         "layout(std430, set = 0, binding = 1) readonly buffer KilnArguments { uint kiln_arguments[]; };\n"
         "uint kiln_held[" +
         words +
         "];\n"
         "uint kiln_change;\n"
         "uint kiln_word(uint at) { return kiln_held[at] ^ kiln_change; }\n"
         "float kiln_float(uint at) { return uintBitsToFloat(kiln_word(at)); }\n"
         "void main() {\n"
         "    uint kiln_bits = 0u;\n    float kiln_sum = 0.0;\n"
         "    for (uint kiln_turn = 0u; kiln_turn < kiln_draw.z; ++kiln_turn) {\n"
         "        uint kiln_set = (gl_GlobalInvocationID.x + 1024u * kiln_turn) % " +
         std::to_string(sets) + "u;\n";
    for (uint32_t w = 0; w < function.words; ++w)
        t += "        kiln_held[" + std::to_string(w) + "] = kiln_arguments[" + std::to_string(w * sets) + "u + kiln_set];\n";
    // The seed is 0 whenever this runs, which the compilers are not told.
    t += "        for (uint kiln_again = 0u; kiln_again < " + std::to_string(same) +
         "u; ++kiln_again) {\n"
         "            kiln_change = (kiln_turn + kiln_again) & kiln_draw.w;\n";
    for (uint32_t w = 0; w < function.words; ++w) t += "            kiln_bits += kiln_word(" + std::to_string(w) + "u);\n";
    if (!baseline) {
        for (const FunctionTest::Slot& a : function.arguments)
            t += "            " + a.glsl + " " + a.name + " = " + a.read + ";\n";
        const bool block = function.call.find(';') != std::string::npos;
        t += "            " + function.result.glsl + " result" +
             (block ? ";\n            {\n            " + function.call + "\n            }\n" : " = " + function.call + ";\n");
        for (const std::string& pick : function.result.picks) t += "            kiln_sum += result" + pick + ";\n";
    }
    return t +
           "        }\n    }\n"
           "    kiln_results[gl_GlobalInvocationID.x] = kiln_sum + uintBitsToFloat(kiln_bits);\n}\n";
}

Result<Cost> measure_cost(const FunctionTest& function, const CostShader& shader) {
    const std::vector<float> arguments = arguments_of(function);
    // The empty loop depends on the number of words alone. Everything else rests on it: the least of three.
    static std::map<uint32_t, double> empty;
    for (int i = empty.count(function.words) == 0 ? 0 : 3; i < 3; ++i) {
        const auto loop = time_loop(function, shader, arguments, 0, true);
        KILN_TRY(loop);
        const double before = i == 0 ? loop->min : empty[function.words];
        empty[function.words] = std::min(before, loop->min);
    }
    const auto loop = time_loop(function, shader, arguments, empty[function.words], false);
    KILN_TRY(loop);
    return Cost{std::max(0.0, loop->min), loop->jit_ms};
}

}  // namespace kiln::test
