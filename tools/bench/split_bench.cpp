// Splitting stages of different shapes. Prints JSON with --benchmark_format=json.

#include <benchmark/benchmark.h>

#include "compiler/split/split.h"

namespace kiln {
namespace {

struct Source {
    Manifest manifest;
    MemoryFiles files;
    StageFile stage;
    explicit Source(size_t axes, uint32_t values) {
        manifest.folder = "m";
        Shader shader;
        shader.name = "s";
        for (size_t a = 0; a < axes; ++a) {
            Axis axis;
            axis.name = axis.macro = "A" + std::to_string(a);
            axis.kind = values == 2 ? AxisKind::boolean : AxisKind::integer;
            for (uint32_t v = 0; v < values; ++v) axis.values.push_back({std::to_string(v), static_cast<int32_t>(v)});
            shader.axes.push_back(static_cast<uint32_t>(manifest.axes.size()));
            manifest.axes.push_back(axis);
        }
        manifest.shaders.push_back(shader);
        stage.stage = Stage::fragment;
        stage.file = "main";
    }
    void run(benchmark::State& state) {
        for (auto _ : state) {
            state.PauseTiming();
            Diags diags;
            const auto space = build_space(manifest, manifest.shaders[0], diags);
            state.ResumeTiming();
            const Split split = split_stage(manifest, manifest.shaders[0], stage, *space, space->legal, files, {});
            state.counters["classes"] = static_cast<double>(split.classes.size());
            state.counters["states"] = static_cast<double>(split.states);
            if (split.diags.has_errors()) state.SkipWithError(split.diags.list().front().message.c_str());
        }
    }
};

// `lines` of code in which every `every`-th block asks an axis.
std::string code(size_t lines, size_t every, size_t axes, size_t asked) {
    std::string out = "#version 450\n#define SATURATE(x) clamp(x, 0.0, 1.0)\n#define PI 3.14159265\n";
    for (size_t i = 0; i < lines; i += 4) {
        const bool ask = (i / 4) % every == 0;
        const std::string axis = "A" + std::to_string((i / 4 / every) % asked % axes);
        if (ask) out += "#if " + axis + " == 1\n";
        out +=
            "    vec3 v" + std::to_string(i) + " = SATURATE(albedo.rgb * PI + roughness * vec3(" + std::to_string(i) + ".5));\n";
        out += ask ? "#endif\n" : "    float d = max(dot(N, L), 0.0); // diffuse\n    color += d * v;\n";
    }
    return out;
}

void uber_150_lines_6_axes(benchmark::State& state) {
    Source source(6, 3);
    source.files.files["m/main"] = code(150, 3, 6, 6);
    source.run(state);
}
BENCHMARK(uber_150_lines_6_axes)->Unit(benchmark::kMicrosecond);

// 20 axes, of which six make different texts.
void uber_5000_lines_20_axes(benchmark::State& state) {
    Source source(20, 4);
    source.files.files["m/main"] = code(5000, 12, 20, 6);
    source.run(state);
}
BENCHMARK(uber_5000_lines_20_axes)->Unit(benchmark::kMillisecond);

void one_variant_of_it(benchmark::State& state) {
    Source source(20, 1);
    source.files.files["m/main"] = code(5000, 12, 20, 6);
    source.run(state);
}
BENCHMARK(one_variant_of_it)->Unit(benchmark::kMillisecond);

void forty_flags_two_used(benchmark::State& state) {
    Source source(40, 2);
    std::string text = "#version 450\n";
    for (int i = 0; i < 40; ++i) {
        const std::string n = std::to_string(i);
        text += "#if A" + n + "\n#define HAS_" + n + " 1\n#else\n#define HAS_" + n + " 0\n#endif\n";
    }
    source.files.files["m/main"] = text + "#if HAS_3\nint a;\n#endif\n#if HAS_7\nint b;\n#endif\n";
    source.run(state);
}
BENCHMARK(forty_flags_two_used)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kiln

BENCHMARK_MAIN();
