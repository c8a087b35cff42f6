// Writes the compute shader of a file's functions, runs it on the device and has the results judged.

#include <cstdio>
#include <cstring>

#include "compiler/base/files.h"
#include "compiler/toolchain/spirv.h"
#include "tests/device/glsl.h"
#include "tests/functions/samples.h"
#include "tests/functions/verdict.h"

namespace kiln::test {

namespace {

constexpr uint32_t group_size = 64;
constexpr uint32_t least_samples = 10000;

// A file of uber/lib with its includes in place; the files guard themselves.
std::string library_text(const std::string& file) {
    const std::string path = std::string(KILN_SOURCE_DIR) + "/uber/lib/" + file;
    Result<std::optional<std::string>> read = DiskFiles().read(path);
    if (!read.ok() || !*read) {
        ADD_FAILURE() << "cannot read " << path;
        return "";
    }
    const std::string& text = **read;
    std::string out;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, end - at);
        const size_t open = line.find('"'), close = line.rfind('"');
        out += line.rfind("#include", 0) == 0 && close > open ? library_text(line.substr(open + 1, close - open - 1)) : line;
        out += "\n";
        at = end + 1;
    }
    return out;
}

Bytes bytes_of(const std::vector<uint32_t>& words) {
    Bytes out(words.size() * 4);
    std::memcpy(out.data(), words.data(), out.size());
    return out;
}

Binding storage(uint32_t binding, const char* name, Bytes data, bool written) {
    Binding b;
    b.kind = ResourceKind::storage_block;
    b.binding = binding;
    b.name = name;
    b.buffers = {std::move(data)};
    b.written = written;
    b.base = BaseType::uint32;
    b.types = {BaseType::uint32};
    return b;
}

void print(const Figures& f) {
    std::printf(
        "KILN_FUNCTION %s %.3g %.3g %.3g %.3g samples=%llu undecided=%llu unbounded=%llu rounding_ulp=%.3g "
        "implementation_ulp=%.3g "
        "model_relative=%.3g typical_bound_ulp=%.3g\n",
        f.name.c_str(), f.absolute, f.relative, f.ulps, f.share, static_cast<unsigned long long>(f.samples),
        static_cast<unsigned long long>(f.undecided), static_cast<unsigned long long>(f.unbounded), f.rounding_ulps,
        f.implementation_ulps, f.model_relative, f.typical_bound_ulps);
    if (f.share > 0.5) std::printf("    nearest to its bound: %s\n", f.worst.c_str());
    std::fflush(stdout);
}

}  // namespace

void Functions::texture(const std::string& declaration, std::shared_ptr<const ImageData> image,
                        const std::function<void(Binding&)>& adjust) {
    Binding b;
    b.kind = ResourceKind::combined_image;
    b.binding = 2 + static_cast<uint32_t>(bindings_.size());
    b.name = declaration.substr(declaration.find_last_of(' ') + 1);
    b.compare = declaration.find("Shadow ") != std::string::npos;
    b.base = image->base;
    b.images = {std::move(image)};
    if (adjust) adjust(b);
    textures_ += "layout(set = 0, binding = " + std::to_string(b.binding) + ") uniform " + declaration + ";\n";
    bindings_.push_back(std::move(b));
}

std::string Functions::shader() const {
    std::string out = "#version 450\n";
    for (const std::string& file : files_) out += library_text(file);
    out += "layout(local_size_x = " + std::to_string(group_size) +
           ") in;\n"
           "layout(std430, set = 0, binding = 0) readonly buffer KilnArguments { uint kiln_arguments[]; };\n"
           "layout(std430, set = 0, binding = 1) buffer KilnResults { uint kiln_results[]; };\n"
           "layout(push_constant) uniform KilnTask { uint kiln_function; uint kiln_samples; };\n"
           "uint kiln_first;\n"
           "uint kiln_word(uint at) { return kiln_arguments[kiln_first + at]; }\n"
           "float kiln_float(uint at) { return uintBitsToFloat(kiln_word(at)); }\n" +
           textures_ + declared_;
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
    std::vector<Figures> out;
    const std::string text = shader();
    const Options options;
    const Compiled compiled = glsl_compile(Stage::compute, text, options);
    for (const ToolMessage& m : compiled.messages)
        if (m.severity == Severity::error) breaches.push_back("line " + std::to_string(m.line) + ": " + m.text);
    if (compiled.words.empty()) {
        breaches.push_back("the generated shader does not compile:\n" + text);
        return out;
    }
    Result<Words> pruned = spirv_prune(compiled.words, options);
    Result<Words> optimised = pruned.ok() ? spirv_optimise(*pruned, options) : std::move(pruned);
    if (!optimised.ok()) {
        breaches.push_back(optimised.error().message);
        return out;
    }

    PipelineRequest request;
    std::vector<std::vector<uint32_t>> samples;
    samples.reserve(tests_.size());
    std::vector<Verdict> verdicts;
    for (size_t t = 0; t < tests_.size(); ++t) {
        const FunctionTest& f = *tests_[t];
        samples.push_back(make_samples(f));
        verdicts.emplace_back(f, samples.back());
        const uint32_t count = static_cast<uint32_t>(samples.back().size() / f.words);
        if (count < least_samples) {
            breaches.push_back(f.name + ": only " + std::to_string(count) + " samples");
            return out;
        }
        Inputs inputs;
        inputs.bindings.push_back(storage(0, "KilnArguments", bytes_of(samples.back()), false));
        inputs.bindings.push_back(storage(1, "KilnResults", Bytes(size_t{count} * f.result.picks.size() * 4, 0xff), true));
        inputs.bindings.insert(inputs.bindings.end(), bindings_.begin(), bindings_.end());
        inputs.push_constants = bytes_of({static_cast<uint32_t>(t), count});
        inputs.groups = {(count + group_size - 1) / group_size, 1, 1};
        request.inputs.push_back(std::move(inputs));
    }
    const std::pair<const char*, const Words*> ways[] = {{"unoptimised", &compiled.words}, {"optimised", &*optimised}};
    for (const auto& [how, words] : ways) {
        request.stages = {stage_of(*words)};
        Result<PipelineOutput> ran = device().run(request);
        if (!ran.ok()) {
            breaches.push_back(ran.error().message);
            return out;
        }
        for (const std::string& e : ran->errors) breaches.push_back(std::string(how) + ": " + e);
        if (!ran->unsupported.empty()) breaches.push_back(std::string(how) + ", unsupported: " + ran->unsupported);
        if (ran->runs.size() != tests_.size()) {
            breaches.push_back(std::string(how) + ": the device did not run every function");
            return out;
        }
        for (size_t t = 0; t < tests_.size(); ++t) verdicts[t].judge(ran->runs[t].values.at(0).words, how, breaches);
    }
    for (Verdict& v : verdicts) out.push_back(v.finish(breaches));
    return out;
}

std::vector<Figures> Functions::run() {
    std::vector<std::string> breaches;
    std::vector<Figures> out = evaluate(breaches);
    for (const Figures& f : out) print(f);
    for (const std::string& b : breaches) ADD_FAILURE() << b;
    EXPECT_EQ(out.size(), tests_.size());
    return out;
}

}  // namespace kiln::test
