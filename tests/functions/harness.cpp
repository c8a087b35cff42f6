// Writes the compute shader of a file's functions, runs it on the device and has the results judged.

#include <cstdio>

#include "compiler/device/compute.h"
#include "tests/device/glsl.h"
#include "tests/device/uber_text.h"
#include "tests/functions/costs.h"
#include "tests/functions/samples.h"
#include "tests/functions/verdict.h"

namespace kiln::test {

namespace {

constexpr uint32_t group_size = 64;
constexpr uint32_t least_samples = 10000;

void print(const Figures& f, const std::string& file) {
    const auto count = [](uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf("KILN_FUNCTION %s %.3g %.3g %.3g %.3g file=%s samples=%llu undecided=%llu unbounded=%llu", f.name.c_str(),
                f.absolute, f.relative, f.ulps, f.share, file.c_str(), count(f.samples), count(f.undecided), count(f.unbounded));
    std::printf(" rounding_ulp=%.3g implementation_ulp=%.3g model_relative=%.3g typical_bound_ulp=%.3g\n", f.rounding_ulps,
                f.implementation_ulps, f.model_relative, f.typical_bound_ulps);
    if (f.share > 0.5) std::printf("    nearest to its bound: %s\n", f.worst.c_str());
    std::fflush(stdout);
}

}  // namespace

void Functions::texture(const std::string& declaration, std::shared_ptr<const ImageData> image,
                        std::optional<SamplerState> sampler) {
    const uint32_t binding = 2 + static_cast<uint32_t>(images_.size());
    textures_ += "layout(set = 0, binding = " + std::to_string(binding) + ") uniform " + declaration + ";\n";
    images_.push_back({declaration.substr(declaration.find_last_of(' ') + 1), std::move(image), sampler});
    comparing_.push_back(declaration.find("Shadow ") != std::string::npos);
}

std::string Functions::prelude() const {
    std::string out = "#version 450\n";
    for (const std::string& file : files_) out += uber_text("lib/" + file);
    return out + textures_ + declared_;
}

std::string Functions::shader() const {
    std::string out = prelude();
    out += "layout(local_size_x = " + std::to_string(group_size) +
           ") in;\n"
           "layout(std430, set = 0, binding = 0) readonly buffer KilnArguments { uint kiln_arguments[]; };\n"
           "layout(std430, set = 0, binding = 1) buffer KilnResults { uint kiln_results[]; };\n"
           "layout(push_constant) uniform KilnTask { uint kiln_function; uint kiln_samples; };\n"
           "uint kiln_first;\n"
           "uint kiln_word(uint at) { return kiln_arguments[kiln_first + at]; }\n"
           "float kiln_float(uint at) { return uintBitsToFloat(kiln_word(at)); }\n";
    std::string cases;
    for (size_t t = 0; t < tests_.size(); ++t) {
        const FunctionTest& f = *tests_[t];
        const std::string name = "kiln_test_" + std::to_string(t);
        out += "void " + name + "(uint sample_) {\n    kiln_first = sample_ * " + std::to_string(f.words) + "u;\n";
        for (const FunctionTest::Slot& a : f.arguments) out += "    " + a.glsl + " " + a.name + " = " + a.read + ";\n";
        const bool block = f.call.find(';') != std::string::npos;
        out += "    " + f.result.glsl + " result" + (block ? ";\n    {\n    " + f.call + "\n    }\n" : " = " + f.call + ";\n");
        const std::string place = "    kiln_results[sample_ * " + std::to_string(f.result.picks.size()) + "u + ";
        for (size_t c = 0; c < f.result.picks.size(); ++c)
            out += place + std::to_string(c) + "u] = floatBitsToUint(result" + f.result.picks[c] + ");\n";
        out += "}\n";
        cases += "        case " + std::to_string(t) + "u: " + name + "(sample_); break;\n";
    }
    return out +
           "void main() {\n    uint sample_ = gl_GlobalInvocationID.x;\n    if (sample_ >= kiln_samples) return;\n"
           "    switch (kiln_function) {\n" +
           cases + "    }\n}\n";
}

std::vector<Figures> Functions::evaluate(std::vector<std::string>& breaches) {
    const std::string text = shader();
    std::vector<std::vector<uint32_t>> samples;
    samples.reserve(tests_.size());  // verdicts refer to them
    std::vector<Verdict> verdicts;
    std::vector<ComputeData> runs;
    for (size_t t = 0; t < tests_.size(); ++t) {
        const FunctionTest& f = *tests_[t];
        samples.push_back(make_samples(f));
        const uint32_t count = static_cast<uint32_t>(samples.back().size() / f.words);
        if (count < least_samples) {
            breaches.push_back(f.name + ": only " + std::to_string(count) + " samples");
            return {};
        }
        verdicts.emplace_back(f, samples.back());
        ComputeData& run = runs.emplace_back();
        run.buffers = {{"KilnArguments", bytes_of(samples.back())},
                       {"KilnResults", Bytes(size_t{count} * f.result.picks.size() * 4, 0xff)}};
        run.images = images_;
        run.push_constants = bytes_of(std::vector<uint32_t>{static_cast<uint32_t>(t), count});
        run.groups = {(count + group_size - 1) / group_size, 1, 1};
    }
    for (const auto& [how, optimise] : {std::pair("unoptimised", Optimise::none), {"optimised", Optimise::performance}}) {
        const Result<StageCode> stage = compute_stage(text, optimise);
        if (!stage.ok()) {
            breaches.push_back(stage.error().message + "\n" + text);
            return {};
        }
        const Result<std::vector<ComputeResult>> ran = run_compute(device(), *stage, runs);
        if (!ran.ok()) {
            breaches.push_back(std::string(how) + ": " + ran.error().message);
            return {};
        }
        for (size_t t = 0; t < tests_.size(); ++t)
            verdicts[t].judge(values_of<uint32_t>((*ran)[t].buffer("KilnResults")), how, breaches);
    }
    std::vector<Figures> out;
    for (Verdict& v : verdicts) out.push_back(v.finish(breaches));
    return out;
}

void Functions::measure() const {
    for (const auto& f : tests_) {
        const Result<Cost> cost = measure_cost(*f, {prelude(), images_, comparing_});
        if (!cost.ok()) {
            ADD_FAILURE() << f->name << ": " << cost.error().message;
            continue;
        }
        std::printf("KILN_COST %s %.3g %.3g file=%s\n", f->name.c_str(), cost->ns, cost->jit_ms, files_.front().c_str());
        std::fflush(stdout);
    }
}

std::vector<Figures> Functions::run() {
    if (costs_wanted()) {
        measure();
        return {};
    }
    std::vector<std::string> breaches;
    std::vector<Figures> out = evaluate(breaches);
    for (const Figures& f : out) print(f, files_.front());
    for (const std::string& b : breaches) ADD_FAILURE() << b;
    EXPECT_EQ(out.size(), tests_.size());
    return out;
}

}  // namespace kiln::test
