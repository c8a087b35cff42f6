// Each stage partitions the needed variants by module; a pipeline is a non-empty intersection of one part of every stage.
// Intersections are operations on the diagram, so the work grows with the parts and never with the variants.

#include "compiler/modules/pipelines.h"

#include <algorithm>
#include <map>

namespace kiln {
namespace {

void extend(const ShaderStages& s, size_t stage, Pipeline partial, std::vector<Pipeline>& out) {
    Diagram& d = *s.space->diagram;
    if (stage == s.stages.size()) {
        partial.count = d.count(partial.variants);
        partial.witness = d.witness(partial.variants).value_or(Digits());
        out.push_back(std::move(partial));
        return;
    }
    Set left = partial.variants;
    for (const auto& [module, variants] : s.modules[stage]) {
        if (left == Diagram::none()) break;
        const Set both = d.both(left, variants);
        if (both == Diagram::none()) continue;
        left = d.minus(left, both);
        Pipeline longer = partial;
        longer.modules.push_back(module);
        longer.variants = both;
        extend(s, stage + 1, std::move(longer), out);
    }
}

}  // namespace

std::vector<ShaderStages> shader_stages(const std::vector<StageClasses>& stages, const Modules& modules) {
    std::vector<ShaderStages> out;
    std::map<const Shader*, size_t> known;
    for (size_t i = 0; i < stages.size(); ++i) {
        const auto [at, fresh] = known.emplace(stages[i].shader, out.size());
        if (fresh) out.push_back({stages[i].shader, stages[i].space, {}, {}});
        ShaderStages& s = out[at->second];
        s.stages.push_back(i);
        auto& parts = s.modules.emplace_back();
        std::map<uint32_t, size_t> index;
        for (size_t c = 0; c < stages[i].split->classes.size(); ++c) {
            const uint32_t module = modules.of_class[i][c];
            const Set variants = stages[i].split->classes[c].variants;
            const auto [part, first] = index.emplace(module, parts.size());
            if (first)
                parts.emplace_back(module, variants);
            else
                parts[part->second].second = s.space->diagram->either(parts[part->second].second, variants);
        }
    }
    return out;
}

std::vector<Pipeline> find_pipelines(const std::vector<ShaderStages>& shaders) {
    std::vector<Pipeline> out;
    for (size_t i = 0; i < shaders.size(); ++i) {
        const ShaderStages& s = shaders[i];
        std::vector<Pipeline> found;
        for (const auto& [module, variants] : s.modules.front()) {
            Pipeline first;
            first.shader = static_cast<uint32_t>(i);
            first.modules = {module};
            first.variants = variants;
            if (variants != Diagram::none()) extend(s, 1, std::move(first), found);
        }
        std::sort(found.begin(), found.end(), [](const Pipeline& a, const Pipeline& b) { return a.witness < b.witness; });
        std::move(found.begin(), found.end(), std::back_inserter(out));
    }
    return out;
}

}  // namespace kiln
