// Counting and asking spaces of different shapes. Prints JSON with --benchmark_format=json.

#include <benchmark/benchmark.h>

#include "compiler/space/describe.h"
#include "compiler/space/space.h"

namespace kiln {
namespace {

Axis axis_of(const std::string& name, uint32_t values) {
    Axis axis;
    axis.name = axis.macro = name;
    axis.kind = values == 2 ? AxisKind::boolean : AxisKind::integer;
    for (uint32_t v = 0; v < values; ++v) axis.values.push_back({std::to_string(v), static_cast<int32_t>(v)});
    return axis;
}

struct Source {
    Manifest manifest;
    Source() { manifest.shaders.resize(1); }
    void axis(const std::string& name, uint32_t values) {
        manifest.shaders[0].axes.push_back(static_cast<uint32_t>(manifest.axes.size()));
        manifest.axes.push_back(axis_of(name, values));
    }
    void rule(bool forbid, const std::string& text) {
        Rule r;
        r.forbid = forbid;
        r.text = text;
        r.place = {"bench.yaml", static_cast<uint32_t>(manifest.shaders[0].rules.size() + 1), 1};
        r.expr = std::get<Expr>(parse_expr(text, manifest.axes));
        manifest.shaders[0].rules.push_back(std::move(r));
    }
    std::unique_ptr<Space> build() {
        Diags diags;
        return build_space(manifest, manifest.shaders[0], diags);
    }
};

std::string name(const char* stem, uint32_t i) { return stem + std::to_string(i); }

void count(benchmark::State& state, const Source& source) {
    Source copy = source;
    Count legal;
    size_t nodes = 0;
    for (auto _ : state) {
        const auto space = copy.build();
        legal = space->diagram->count(space->legal);
        benchmark::DoNotOptimize(space->diagram->count_by_digits(space->legal));
        nodes = space->diagram->nodes();
    }
    state.counters["nodes"] = static_cast<double>(nodes);
    state.SetLabel(legal.decimal());
}

Source chain(uint32_t axes) {
    Source s;
    for (uint32_t i = 0; i < axes; ++i) s.axis(name("f", i), 2);
    for (uint32_t i = 0; i + 1 < axes; ++i) s.rule(true, name("f", i) + " && " + name("f", i + 1));
    return s;
}
Source pairs(uint32_t pairs) {
    Source s;
    for (uint32_t i = 0; i < pairs; ++i) s.axis(name("a", i), 2);
    for (uint32_t i = 0; i < pairs; ++i) s.axis(name("b", i), 2);
    for (uint32_t i = 0; i < pairs; ++i) s.rule(false, name("a", i) + " == " + name("b", i));
    return s;
}
Source large_product() {
    Source s;  // 27,179,089,920 = 2^26 * 3^4 * 5
    for (uint32_t i = 0; i < 4; ++i) s.axis(name("t", i), 3);
    s.axis("five", 5);
    for (uint32_t i = 0; i < 26; ++i) s.axis(name("f", i), 2);
    return s;
}
// Rules over random axes near each other, declared in an order that says nothing.
Source scattered(uint32_t axes, uint32_t rules, uint32_t reach) {
    Source s;
    for (uint32_t i = 0; i < axes; ++i) s.axis(name("f", i), i % 4 == 0 ? 4 : 2);
    uint32_t seed = 12345;
    const auto draw = [&](uint32_t n) {
        seed = seed * 1664525 + 1013904223;
        return (seed >> 8) % n;
    };
    for (uint32_t r = 0; r < rules; ++r) {
        const uint32_t start = draw(axes);
        const auto pick = [&] { return name("f", (start + draw(reach)) * 37 % axes); };
        s.rule(true, pick() + " && !" + pick() + " && " + pick() + " != 1");
    }
    return s;
}
Source compared(uint32_t values) {
    Source s;
    s.axis("a", values);
    s.axis("b", values);
    s.axis("c", values);
    s.rule(false, "a == b");
    s.rule(false, "b < c");
    return s;
}
Source wide(uint32_t axes, uint32_t values) {
    Source s;
    for (uint32_t i = 0; i < axes; ++i) s.axis(name("f", i), values);
    for (uint32_t i = 0; i + 1 < axes; ++i) s.rule(false, name("f", i) + " == 0 -> " + name("f", i + 1) + " < 100");
    return s;
}

void preprocessor_like(benchmark::State& state) {
    Source source = scattered(40, 60, 6);
    const auto space = source.build();
    Diagram& d = *space->diagram;
    for (auto _ : state) {
        std::vector<Set> parts{space->legal};
        for (uint32_t axis = 0; axis < 8; ++axis) {
            std::vector<Set> next;
            for (const Set s : parts) {
                const Set yes = d.where(axis, 1);
                for (const Set part : {d.both(s, yes), d.minus(s, yes)})
                    if (part != Diagram::none()) next.push_back(part);
            }
            parts = std::move(next);
        }
        benchmark::DoNotOptimize(parts);
    }
}

void describe(benchmark::State& state, const char* words) {
    Source source = scattered(40, 60, 6);
    const auto space = source.build();
    const Expr expr = std::get<Expr>(parse_expr(words, space->axes));
    const Set set = space->diagram->both(space->legal, compile_expr(*space, expr));
    std::string text;
    for (auto _ : state) text = describe_set(*space, set, space->legal);
    state.SetLabel(text);
}

void lint_rules(benchmark::State& state, const Source& source) {
    Source copy = source;
    std::vector<std::unique_ptr<Space>> spaces;
    spaces.push_back(copy.build());
    size_t found = 0;
    for (auto _ : state) {
        Diags diags;
        lint(copy.manifest, spaces, diags);
        found = diags.list().size();
    }
    state.counters["found"] = static_cast<double>(found);
}

BENCHMARK_CAPTURE(count, chain_60, chain(60))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, chain_1024, chain(1024))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, pairs_32, pairs(32))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, pairs_500, pairs(500))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, product_27179089920, large_product())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, scattered_60, scattered(60, 80, 6))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, scattered_1000, scattered(1000, 1000, 5))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, tangled_40, scattered(40, 40, 40))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, compared_4096, compared(4096))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(count, wide_256x4096, wide(256, 4096))->Unit(benchmark::kMillisecond);
BENCHMARK(preprocessor_like)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(describe, one, "f3")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, two, "f3 && f8 == 2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, alternatives, "f3 && f8 == 2 || !f5 && f12 != 0")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, too_long, "f3 && f8 == 2 && f5 && f6 && f9 && f10")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, tangled, "f3 && f8 == 2 || !f5 && f12 == 3 || f3 && f12 != 1 && f6")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(describe, parity, "(f1 == f2) == (f3 == f4)")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lint_rules, chain_1024, chain(1024))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lint_rules, scattered_1000, scattered(1000, 1000, 5))->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kiln

BENCHMARK_MAIN();
