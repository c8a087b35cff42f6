// Pipelines are many, their interfaces few: reflections are numbered by what a check looks at, and each distinct pair is
// checked once. What is found is then gathered per message with the union of the pipelines' variants, which gives the exact
// condition.

#include "compiler/interfaces/interfaces.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "compiler/interfaces/layout_moves.h"
#include "compiler/interfaces/mismatch.h"
#include "compiler/space/describe.h"

namespace kiln {
namespace {

// Numbers equal things equally.
template <class T>
class Numbering {
public:
    uint32_t of(const T& thing) {
        for (uint32_t i = 0; i < known_.size(); ++i)
            if (*known_[i] == thing) return i;
        known_.push_back(&thing);
        return static_cast<uint32_t>(known_.size() - 1);
    }

private:
    std::vector<const T*> known_;  // not owned
};

struct Numbers {
    uint32_t inputs = 0, outputs = 0, resources = 0;
};

bool draws(Stage stage) { return stage <= Stage::fragment || stage == Stage::mesh; }

class Checker {
public:
    Checker(const std::vector<StageClasses>& stages, const Modules& modules)
        : stages_(stages), modules_(modules), shaders_(shader_stages(stages, modules)) {}

    Interfaces run() {
        number();
        out_.pipelines = find_pipelines(shaders_);
        for (const Pipeline& p : out_.pipelines) check(p);
        report();
        for (const ShaderStages& s : shaders_) report_layouts(s, stages_, modules_, out_.diags);
        out_.diags.sort();
        return std::move(out_);
    }

private:
    using Found = std::vector<Mismatch>;

    void number() {
        Numbering<std::vector<Varying>> varyings;
        Numbering<std::vector<Resource>> resources;
        for (const Module& m : modules_.list) {
            const Reflection& r = m.reflection;
            numbers_.push_back({varyings.of(r.inputs), varyings.of(r.outputs), resources.of(r.resources)});
        }
    }

    void check(const Pipeline& p) {
        const ShaderStages& s = shaders_[p.shader];
        for (size_t i = 0; i < p.modules.size(); ++i) {
            const Reflection& a = modules_.list[p.modules[i]].reflection;
            const Numbers& na = numbers_[p.modules[i]];
            add(p, s.stages[i], overlaps_, std::tuple{a.stage, a.stage, na.inputs, na.outputs},
                [&] { return overlapping_varyings(a); });
            for (size_t j = i + 1; j < p.modules.size(); ++j) {
                const Reflection& b = modules_.list[p.modules[j]].reflection;
                const Numbers& nb = numbers_[p.modules[j]];
                if (j == i + 1 && draws(a.stage) && draws(b.stage))
                    add(p, s.stages[j], varyings_, std::tuple{a.stage, b.stage, na.outputs, nb.inputs},
                        [&] { return match_varyings(a, b); });
                add(p, s.stages[j], resources_, std::tuple{a.stage, b.stage, na.resources, nb.resources},
                    [&] { return match_resources(a, b); });
            }
        }
    }

    using Key = std::tuple<Stage, Stage, uint32_t, uint32_t>;

    template <class Check>
    void add(const Pipeline& p, size_t stage, std::map<Key, Found>& cache, const Key& key, const Check& run_check) {
        auto known = cache.find(key);
        if (known == cache.end()) known = cache.emplace(key, run_check()).first;
        for (const Mismatch& m : known->second) {
            Set& set = found_[{p.shader, stage, m}];
            set = shaders_[p.shader].space->diagram->either(set, p.variants);
        }
    }

    void report() {
        for (const auto& [key, set] : found_) {
            const auto& [shader, stage, mismatch] = key;
            const StageClasses& classes = stages_[stage];
            Diag& diag = out_.diags.add(mismatch.severity,
                                        {classes.split->files.empty() ? std::string() : classes.split->files.front(), 0, 0},
                                        mismatch.message);
            diag.notes.push_back(describe_condition(*classes.space, set, classes.space->needed));
        }
    }

    const std::vector<StageClasses>& stages_;
    const Modules& modules_;
    std::vector<ShaderStages> shaders_;
    std::vector<Numbers> numbers_;  // by module
    std::map<Key, Found> overlaps_, varyings_, resources_;
    std::map<std::tuple<uint32_t, size_t, Mismatch>, Set> found_;
    Interfaces out_;
};

}  // namespace

Interfaces check_interfaces(const std::vector<StageClasses>& stages, const Modules& modules) {
    return Checker(stages, modules).run();
}

}  // namespace kiln
