// A table's lookup against std::unordered_map on the same random keys: all stages' modules of a variant of the shape of
// surface (six axes, about a thousand combinations), and of a shader with 44 axes and more than 10^12 legal variants, where
// the map can hold only the keys that are asked. Prints nanoseconds a lookup (--benchmark_format=json for machines).
#include <benchmark/benchmark.h>

#include <random>
#include <unordered_map>

#include "compiler/runtime/kiln.h"
#include "tests/unit/table/sample.h"

namespace {

using kiln::Digits;

struct Case {
    std::unique_ptr<kiln::test::Sample> sample;
    kiln::Bytes bytes;
    kiln_table table;
    kiln_shader shader;
    std::vector<uint64_t> keys;  // random ones, found and forbidden mixed as they come
    std::unordered_map<uint64_t, std::array<uint32_t, 2>> map;
};

constexpr size_t key_count = 1u << 14;

void finish(Case& c) {
    c.bytes = write_table(c.sample->input())->table;
    if (kiln_open(&c.table, c.bytes.data(), c.bytes.size()) != KILN_OK || kiln_get_shader(&c.table, 0, &c.shader) != KILN_OK)
        std::abort();
    std::mt19937 random(7);
    const kiln::Space& space = c.sample->space(0);
    for (size_t i = 0; i < key_count; ++i) {
        Digits digits;
        for (const kiln::Axis& axis : space.axes) digits.push_back(static_cast<uint32_t>(random() % axis.values.size()));
        uint64_t key = 0;
        uint32_t modules[KILN_MAX_STAGES];
        kiln_pack(&c.shader, digits.data(), &key);
        c.keys.push_back(key);
        if (kiln_find(&c.shader, &key, modules) == KILN_OK) c.map[key] = {modules[0], modules[1]};
    }
}

Case& surface() {
    static Case* made = [] {
        using namespace kiln::test;
        SampleShader s;
        s.name = "surface";
        s.axes = {named("light", {"none", "directional", "point", "spot"}),
                  named("pass", {"forward", "gbuffer", "depth", "velocity"}),
                  named("material", {"blinn_phong", "pbr_mr", "pbr_sg"}),
                  named("lightmap", {"none", "flat", "sh_lq", "sh_hq"}),
                  boolean("two_sided"),
                  named("shadow", {"none", "hard"})};
        s.forbid = {"light == none && lightmap == none", "light == none && shadow != none",
                    "pass == depth && material != blinn_phong", "pass == velocity && shadow != none"};
        const auto text = [](std::vector<uint32_t> axes) {
            return [axes](const Digits& d) {
                std::string out;
                for (const uint32_t a : axes) out += static_cast<char>('a' + d[a]);
                return out;
            };
        };
        s.stages = {{kiln::Stage::vertex, {1, 3}, text({1, 3})},
                    {kiln::Stage::fragment, {0, 1, 2, 3, 4, 5}, text({0, 1, 2, 3, 4, 5})}};
        auto* c = new Case;
        c->sample = std::make_unique<Sample>(std::vector<SampleShader>{s});
        finish(*c);
        return c;
    }();
    return *made;
}

Case& huge() {
    static Case* made = [] {
        using namespace kiln::test;
        SampleShader s;
        s.name = "huge";
        for (int i = 0; i < 44; ++i)
            s.axes.push_back(named("x" + std::to_string(i),
                                   i % 3 == 0 ? std::vector<std::string>{"a", "b", "c"} : std::vector<std::string>{"a", "b"}));
        for (int i = 0; i < 40; i += 4)
            s.forbid.push_back("x" + std::to_string(i) + " == b && x" + std::to_string(i + 3) + " == a");
        SampleStage fragment{kiln::Stage::fragment, {0, 5, 20, 43}, {}, {}}, vertex{kiln::Stage::vertex, {1, 43}, {}, {}};
        for (const char* a : {"x0 == a", "x0 == b", "x0 == c"})
            for (const char* b : {"x5 == a", "x5 == b"})
                for (const char* c : {"(x43 == a && x20 == a)", "!(x43 == a && x20 == a)"})
                    fragment.conditions.push_back(std::string(a) + " && " + b + " && " + c);
        vertex.conditions = {"x1 == a && x43 == a", "x1 == a && x43 == b", "x1 == b && x43 == a", "x1 == b && x43 == b"};
        s.stages = {vertex, fragment};
        auto* c = new Case;
        c->sample = std::make_unique<Sample>(std::vector<SampleShader>{s});
        finish(*c);
        return c;
    }();
    return *made;
}

void table_lookup(benchmark::State& state, Case& c) {
    size_t i = 0, found = 0;
    uint32_t modules[KILN_MAX_STAGES] = {};
    for (auto _ : state) {
        found += kiln_find(&c.shader, &c.keys[i], modules) == KILN_OK;
        benchmark::DoNotOptimize(modules);
        i = (i + 1) % key_count;
    }
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(state.iterations());
    state.counters["table_bytes"] = static_cast<double>(c.bytes.size());
}

void map_lookup(benchmark::State& state, Case& c) {
    size_t i = 0, found = 0;
    uint32_t modules[2] = {};
    for (auto _ : state) {
        const auto it = c.map.find(c.keys[i]);
        if (it != c.map.end()) {
            ++found;
            modules[0] = it->second[0];
            modules[1] = it->second[1];
        }
        benchmark::DoNotOptimize(modules);
        i = (i + 1) % key_count;
    }
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(state.iterations());
    state.counters["entries"] = static_cast<double>(c.map.size());
}

void surface_table(benchmark::State& state) { table_lookup(state, surface()); }
void surface_map(benchmark::State& state) { map_lookup(state, surface()); }
void huge_table(benchmark::State& state) { table_lookup(state, huge()); }
void huge_map(benchmark::State& state) { map_lookup(state, huge()); }

BENCHMARK(surface_table);
BENCHMARK(surface_map);
BENCHMARK(huge_table);
BENCHMARK(huge_map);

}  // namespace

BENCHMARK_MAIN();
