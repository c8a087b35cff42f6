// What is translated is a module together with the slots of its own resources, so shaders that share a module usually share
// its texts as well. A unit of work is one such pair with all targets that the store does not have, because the module is
// then parsed once. Everything that touches a diagram happens before or after the parallel loops.

#include "compiler/translate/translate.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <tuple>
#include <unordered_map>

#include "compiler/space/describe.h"
#include "compiler/toolchain/edits.h"
#include "compiler/translate/parse_back.h"
#include "compiler/translate/translate_record.h"

namespace kiln {
namespace {

struct Unit {
    uint32_t module = 0;
    SlotLayout layout;                // of the module's own resources
    std::vector<Translated> results;  // one per wanted target
    std::vector<uint8_t> hit;
    std::vector<Digest> actions;
};

class Translator {
public:
    Translator(const std::vector<StageClasses>& stages, const Modules& modules, const TranslateOptions& options, Store& store,
               Toolchain& tools, const Jobs& jobs, const Progress& progress, Elsewhere* elsewhere)
        : stages_(stages),
          modules_(modules),
          options_(options),
          store_(store),
          tools_(tools),
          jobs_(jobs),
          progress_(progress),
          elsewhere_(elsewhere),
          shaders_(shader_stages(stages, modules)) {
        for (size_t t = 0; t < options.targets.size(); ++t)
            if (options.targets[t] != Target::spirv) wanted_.push_back(t);
    }

    Artifacts run() {
        collect();
        const bool complete = translate();
        if (complete) {
            number();
            report_refusals();
            if (options_.parse_back) parse_texts_back(context(), shaders_, out_);
        }
        if (out_.store_failures != 0)
            out_.diags.warning(
                {}, "the cache failed " + std::to_string(out_.store_failures) + " times and was done without: " + store_problem_);
        out_.diags.sort();
        return std::move(out_);
    }

private:
    ParseBackContext context() { return {stages_, modules_, options_.targets, store_, tools_, jobs_, progress_}; }

    // Slots per shader, and the distinct units in the order of shaders and modules.
    void collect() {
        std::map<std::pair<uint32_t, Bytes>, size_t> known;
        for (const ShaderStages& s : shaders_) {
            std::vector<uint32_t> used;
            for (const auto& parts : s.modules)
                for (const auto& part : parts) used.push_back(part.first);
            std::vector<const Reflection*> reflections;
            for (const uint32_t m : used) reflections.push_back(&modules_.list[m].reflection);
            SlotLayout layout = assign_slots(reflections);
            auto& units = unit_of_.emplace_back(modules_.list.size(), no_artifact);
            for (const uint32_t m : used) {
                if (units[m] != no_artifact) continue;
                Unit unit{m, own_slots(layout, modules_.list[m].reflection), {}, {}, {}};
                const auto [at, fresh] = known.emplace(std::pair{m, write_slots(unit.layout)}, units_.size());
                if (fresh) units_.push_back(std::move(unit));
                units[m] = static_cast<uint32_t>(at->second);
            }
            out_.slots.push_back(std::move(layout));
        }
    }

    static SlotLayout own_slots(const SlotLayout& layout, const Reflection& reflection) {
        SlotLayout own = layout;
        std::vector<const Slot*> used;
        for (const Resource& r : reflection.resources) used.push_back(find_slot(layout, r));
        own.slots.clear();
        // Only the last stage before the rasteriser asks how its outputs are read.
        own.interpolation.clear();
        for (const Interpolation& i : layout.interpolation) {
            const bool written = std::any_of(reflection.outputs.begin(), reflection.outputs.end(),
                                             [&](const Varying& v) { return v.location == i.location; });
            if (written && reflection.stage == layout.rasterised) own.interpolation.push_back(i);
        }
        for (const Slot& s : layout.slots)
            if (std::find(used.begin(), used.end(), &s) != used.end()) own.slots.push_back(s);
        return own;
    }

    bool translate() {
        const std::string identity = tools_.identity();
        const bool named = jobs_.each(units_.size(), [&](size_t u) {
            for (const size_t t : wanted_)
                units_[u].actions.push_back(
                    artifact_action(identity, options_.targets[t], units_[u].layout, modules_.list[units_[u].module].digest));
        });
        if (!named) return false;
        std::vector<Digest> asked;
        for (const Unit& unit : units_) asked.insert(asked.end(), unit.actions.begin(), unit.actions.end());
        if (elsewhere_) {
            std::vector<Target> targets;
            for (const size_t t : wanted_) targets.push_back(options_.targets[t]);
            std::vector<ArtifactQuestion> questions;
            for (const Unit& unit : units_)
                questions.push_back({modules_.list[unit.module].words, &unit.layout, targets, unit.actions});
            elsewhere_->artifacts(questions);
        }
        store_.expect(asked);
        size_t done = 0;
        return jobs_.each(units_.size(), [&](size_t u) {
            Unit& unit = units_[u];
            const Module& module = modules_.list[unit.module];
            unit.results.resize(wanted_.size());
            unit.hit.resize(wanted_.size());
            std::vector<Target> misses;
            std::vector<size_t> places;
            for (size_t t = 0; t < wanted_.size(); ++t) {
                if (auto got = recall(unit.actions[t])) {
                    unit.results[t] = std::move(*got);
                    unit.hit[t] = 1;
                } else {
                    misses.push_back(options_.targets[wanted_[t]]);
                    places.push_back(t);
                }
            }
            if (!misses.empty()) {
                std::vector<Translated> fresh = tools_.translate(module.words, misses, unit.layout);
                for (size_t i = 0; i < misses.size(); ++i) {
                    Translated& result = unit.results[places[i]];
                    result = i < fresh.size() ? std::move(fresh[i]) : Translated{{}, "the translator gave nothing"};
                    if (result.text.empty() && result.refusal.empty()) result.refusal = "the text is empty";
                    remember(unit.actions[places[i]], result);
                }
            }
            const std::lock_guard lock(mutex_);
            out_.translated += misses.size();
            out_.cache_hits += wanted_.size() - misses.size();
            if (progress_) progress_("translate", ++done, units_.size());
        });
    }

    std::optional<Translated> recall(const Digest& action) {
        const std::optional<Bytes> bytes = get(Keyspace::action, action);
        if (!bytes) return std::nullopt;
        const std::optional<ArtifactRecord> record = read_artifact_record(action, *bytes);
        if (!record) return std::nullopt;
        if (!record->refusal.empty()) return Translated{{}, record->refusal};
        const std::optional<Bytes> text = get(Keyspace::blob, record->text);
        if (!text || text->empty() || sha256(*text) != record->text) return std::nullopt;
        return Translated{std::string(as_text(*text)), {}};
    }

    void remember(const Digest& action, const Translated& result) {
        ArtifactRecord record;
        record.refusal = result.refusal;
        if (result.refusal.empty()) {
            record.text = sha256(as_bytes(result.text));
            put(Keyspace::blob, record.text, as_bytes(result.text));
        }
        const std::span<const Digest> blobs(&record.text, result.refusal.empty() ? 1 : 0);
        const Status done = store_.put_record(action, write_artifact_record(action, record), blobs);
        if (!done.ok()) failed(done.error());
    }

    std::optional<Bytes> get(Keyspace space, const Digest& key) {
        Result<std::optional<Bytes>> got = store_.get(space, key);
        if (got.ok()) return std::move(*got);
        failed(got.error());
        return std::nullopt;
    }

    void put(Keyspace space, const Digest& key, ByteView bytes) {
        const Status done = store_.put(space, key, bytes);
        if (!done.ok()) failed(done.error());
    }

    void failed(const Error& error) {
        const std::lock_guard lock(mutex_);
        if (out_.store_failures++ == 0) store_problem_ = error.message;
    }

    // Equal texts of one target become one artifact.
    void number() {
        std::map<Target, std::unordered_map<std::string_view, uint32_t>> known;
        // Views into the units' own texts, which stay where they are until the end.
        out_.of.resize(shaders_.size());
        for (size_t s = 0; s < shaders_.size(); ++s) {
            out_.of[s].assign(options_.targets.size(), std::vector<uint32_t>(modules_.list.size(), no_artifact));
            for (size_t t = 0; t < wanted_.size(); ++t) {
                const Target target = options_.targets[wanted_[t]];
                for (uint32_t m = 0; m < modules_.list.size(); ++m) {
                    if (unit_of_[s][m] == no_artifact) continue;
                    const Translated& result = units_[unit_of_[s][m]].results[t];
                    if (!result.refusal.empty()) {
                        out_.refusals[{static_cast<uint32_t>(s), static_cast<uint32_t>(wanted_[t]), m}] = result.refusal;
                        continue;
                    }
                    const auto [at, fresh] = known[target].emplace(result.text, static_cast<uint32_t>(out_.list.size()));
                    if (fresh) out_.list.push_back({target, result.text});
                    out_.of[s][wanted_[t]][m] = at->second;
                }
            }
        }
    }

    // One warning per stage and reason, naming the targets that share it and the variants that it hits.
    void report_refusals() {
        std::map<std::tuple<size_t, std::string, Target>, Set> holes;
        for (const auto& [where, why] : out_.refusals) {
            const ShaderStages& s = shaders_[where[0]];
            for (size_t i = 0; i < s.stages.size(); ++i)
                for (const auto& [module, variants] : s.modules[i]) {
                    if (module != where[2]) continue;
                    Set& set = holes[{s.stages[i], why, options_.targets[where[1]]}];
                    set = s.space->diagram->either(set, variants);
                }
        }
        std::map<std::tuple<size_t, std::string, Set>, std::vector<Target>> groups;
        for (const auto& [key, set] : holes) groups[{std::get<0>(key), std::get<1>(key), set}].push_back(std::get<2>(key));
        for (const auto& [key, targets] : groups) {
            const auto& [stage, why, set] = key;
            const StageClasses& classes = stages_[stage];
            std::string names;
            for (const Target t : targets) names += (names.empty() ? "" : ", ") + std::string(name_of(t));
            Diag& diag = out_.diags.warning({classes.split->files.empty() ? std::string() : classes.split->files.front(), 0, 0},
                                            "no " + names + " text of the " + name_of(classes.stage) + " stage: " + why);
            diag.notes.push_back(describe_condition(*classes.space, set, classes.space->needed));
        }
    }

    const std::vector<StageClasses>& stages_;
    const Modules& modules_;
    const TranslateOptions& options_;
    Store& store_;
    Toolchain& tools_;
    const Jobs& jobs_;
    const Progress& progress_;
    Elsewhere* const elsewhere_;
    std::vector<ShaderStages> shaders_;
    std::vector<size_t> wanted_;  // indices of targets that are not spirv
    std::vector<Unit> units_;
    std::vector<std::vector<uint32_t>> unit_of_;  // [shader][module], no_artifact: unused
    std::mutex mutex_;                            // counters, progress, store failures
    std::string store_problem_;
    Artifacts out_;
};

}  // namespace

Artifacts translate_modules(const std::vector<StageClasses>& stages, const Modules& modules, const TranslateOptions& options,
                            Store& store, Toolchain& tools, const Jobs& jobs, const Progress& progress, Elsewhere* elsewhere) {
    return Translator(stages, modules, options, store, tools, jobs, progress, elsewhere).run();
}

}  // namespace kiln
