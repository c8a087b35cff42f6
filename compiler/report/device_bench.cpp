#include "compiler/report/device_bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "compiler/device/vulkan_device.h"

namespace kiln::report {

namespace {

constexpr double most_loops = 16384;
constexpr uint32_t most_enlarged = 256;

Bytes bytes_of(const void* data, size_t size) {
    Bytes out(size);
    if (size != 0) std::memcpy(out.data(), data, size);
    return out;
}

Binding buffer(uint32_t binding, const char* name, Bytes bytes, bool written) {
    Binding b;
    b.kind = ResourceKind::storage_block;
    b.binding = binding;
    b.name = name;
    b.types.assign(1, BaseType::float32);
    b.buffers.push_back(std::move(bytes));
    b.written = written;
    return b;
}

PipelineRequest request_of(const Kernel& kernel, const std::vector<Resource>& resources, const Draw& draw) {
    Inputs in;
    in.bindings.push_back(buffer(0, "results", Bytes(std::max<size_t>(draw.results, 1) * 4), true));
    if (draw.points != nullptr)
        in.bindings.push_back(buffer(1, "points", bytes_of(draw.points->data(), draw.points->size() * 4), false));
    for (size_t i = 0; i < resources.size(); ++i) {
        Binding b = resources[i].binding;
        b.set = 0;
        b.binding = static_cast<uint32_t>(i + 2);
        // What the shader does not read after all was optimised away, and is bound no more than it is declared.
        const auto& known = kernel.code.reflection.resources;
        if (std::any_of(known.begin(), known.end(), [&](const auto& r) { return r.set == 0 && r.binding == b.binding; }))
            in.bindings.push_back(std::move(b));
    }
    const uint32_t push[4] = {draw.width, draw.height, draw.loops, draw.seed};
    in.push_constants = bytes_of(push, sizeof push);
    in.groups = {draw.groups, 1, 1};
    PipelineRequest request;
    request.stages.push_back(kernel.code);
    request.inputs.push_back(std::move(in));
    return request;
}

template <class Output>
Status status_of(const Output& output) {
    if (!output.unsupported.empty())
        return environment_error("the device cannot run a shader of the report: " + output.unsupported);
    if (!output.errors.empty()) return environment_error("the device refused a shader of the report: " + output.errors.front());
    return {};
}

class DeviceBench final : public Bench {
public:
    DeviceBench(std::unique_ptr<Device> checked, std::unique_ptr<Device> timed, Toolchain& tools, Library& library)
        : checked_(std::move(checked)), timed_(std::move(timed)), tools_(tools), library_(library) {}

    const DeviceInfo& info() const override { return timed_->info(); }

    Result<std::vector<float>> run(const Kernel& kernel, const std::vector<Resource>& resources, const Draw& draw) override {
        const auto output = checked_->run(request_of(kernel, resources, draw));
        KILN_TRY(output);
        KILN_TRY(status_of(*output));
        std::vector<float> out(draw.results);
        for (const RunOutput& run : output->runs)
            for (const ReadBack& back : run.values)
                if (back.what.find("results") != std::string::npos && back.words.size() >= out.size()) {
                    std::memcpy(out.data(), back.words.data(), out.size() * 4);
                    return out;
                }
        return environment_error("the device gave no results back");
    }

    Result<Timed> time(const Kernel& kernel, const std::vector<Resource>& resources, Draw& draw, unsigned repeats,
                       double least_ms) override {
        // Room for all the pixels that enlarging may come to.
        const uint32_t fewest = draw.groups;
        draw.results *= most_enlarged;
        TimeOptions options;
        options.repeats = repeats;
        std::optional<double> trial_ms;
        options.enlarge = [&](uint64_t least_ns, Bytes& push_constants, std::array<uint32_t, 3>& groups) {
            const double ms = 1e-6 * static_cast<double>(least_ns);
            if (!trial_ms) trial_ms = ms;
            if (ms >= least_ms || interrupted.load()) return false;
            // A dispatch of few loops is mostly its own overhead: grow in steps until the loop dominates. llvmpipe ends every
            // loop of a shader after 65535 turns in all, so more pixels are taken where more turns would be too many.
            const double loops = std::ceil(draw.loops * std::clamp(1.15 * least_ms / std::max(ms, 1e-4), 1.02, 64.0));
            if (loops > most_loops) {
                const double more = std::ceil(loops / most_loops);
                if (draw.groups * more > fewest * most_enlarged) return false;
                draw.groups *= static_cast<uint32_t>(more);
                draw.loops = static_cast<uint32_t>(std::ceil(loops / more));
            } else {
                draw.loops = static_cast<uint32_t>(loops);
            }
            std::memcpy(push_constants.data() + 8, &draw.loops, 4);
            groups[0] = draw.groups;
            return true;
        };
        const auto output = timed_->time(request_of(kernel, resources, draw), options);
        KILN_TRY(output);
        KILN_TRY(status_of(*output));
        if (interrupted.load()) return environment_error("interrupted");
        if (output->samples_ns.empty()) return environment_error("the device gave no times back");
        Timed out;
        out.jit_ms = std::max(0.0, output->first_ms - trial_ms.value_or(0.0));
        for (const uint64_t ns : output->samples_ns) out.ms.push_back(1e-6 * static_cast<double>(ns));
        return out;
    }

    Result<std::vector<float>> bake(const std::string& text, const std::vector<Resource>& resources, const Draw& draw) override {
        const auto whole = library_.expanded(text);
        KILN_TRY(whole);
        const auto kernel = compile_kernel(*whole, tools_);
        KILN_TRY(kernel);
        return run(*kernel, resources, draw);
    }

private:
    std::unique_ptr<Device> checked_, timed_;
    Toolchain& tools_;
    Library& library_;
};

}  // namespace

Result<std::unique_ptr<Bench>> open_device_bench(const DriverChoice& choice, Toolchain& tools, Library& library) {
    DriverChoice checked = choice, timed = choice;
    checked.optimise = timed.optimise = true;
    // Pictures may come from Mesa's cache, as most scenes of a family make the same shader; what is timed is compiled anew.
    // Mesa reads the switch when a device is opened.
    timed.shader_cache = timed.layer = false;
    auto first = open_vulkan_device(checked);
    KILN_TRY(first);
    auto second = open_vulkan_device(timed);
    KILN_TRY(second);
    return std::unique_ptr<Bench>(std::make_unique<DeviceBench>(std::move(*first), std::move(*second), tools, library));
}

}  // namespace kiln::report
