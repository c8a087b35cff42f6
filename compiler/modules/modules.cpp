// The order of work follows its price. A class found in the store costs two reads. Else it is compiled and pruned, about 2.5 ms;
// only what is distinct after pruning is optimised and validated, about 3 ms more; only what is distinct after that is reflected.
// An invalid pruned module stays invalid when optimised, so validating the final one is enough; the pruned one is only asked to
// find out whose mistake it was.
// Each step runs over a list in parallel and writes to its own slot; merging is by content (WordPool) and numbering by
// the order of classes, so threads leave no trace.

#include "compiler/modules/modules.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>

#include "compiler/modules/blame.h"
#include "compiler/modules/module_pool.h"
#include "compiler/modules/module_record.h"
#include "compiler/toolchain/messages.h"

namespace kiln {
namespace {

// A distinct question to the tools. Classes of several shaders may ask the same one.
struct Unit {
    Stage stage = Stage::vertex;
    Options options;
    std::string_view text;
    Digest action;
    std::vector<std::pair<size_t, size_t>> classes;  // (stage index, class index)

    bool hit = false;
    ModuleRecord record;
    SharedWords pruned, final;
};

// A pruned module and how to optimise it.
struct Candidate {
    const Unit* unit = nullptr;  // the first that it is made of
    SharedWords pruned, final;
    Options options;
    Digest pruned_digest, final_digest;
    std::vector<ToolMessage> messages;
};

class Ticker {
public:
    Ticker(const Progress& progress, const char* what, size_t total) : progress_(progress), what_(what), total_(total) {}
    void tick() {
        if (!progress_) return;
        const std::lock_guard lock(mutex_);
        progress_(what_, ++done_, total_);
    }

private:
    const Progress& progress_;
    const char* what_;
    size_t total_, done_ = 0;
    std::mutex mutex_;
};

Digest digest_of(const Words& words) { return sha256(as_bytes(WordView(words))); }

class Builder {
public:
    Builder(const std::vector<StageClasses>& stages, Store& store, Toolchain& tools, const Jobs& jobs, const Progress& progress,
            const SourceLines& lines, Elsewhere* elsewhere)
        : stages_(stages), store_(store), tools_(tools), jobs_(jobs), progress_(progress), lines_(lines), elsewhere_(elsewhere) {}

    Modules run() {
        collect();
        for (bool (Builder::*const step)() :
             {&Builder::look_up, &Builder::compile, &Builder::optimise, &Builder::gather, &Builder::remember}) {
            if (failed_) break;  // with all of this step's errors collected
            complete_ = (this->*step)();
            if (!complete_) break;
        }
        report();
        return std::move(out_);
    }

private:
    // Distinct units, in the order of stages and classes.
    void collect() {
        const std::string identity = tools_.identity();
        std::map<Digest, size_t> known;
        unit_of_.resize(stages_.size());
        for (size_t s = 0; s < stages_.size(); ++s) {
            const StageClasses& stage = stages_[s];
            for (size_t c = 0; c < stage.split->classes.size(); ++c) {
                const std::string& text = stage.split->classes[c].text;
                const Digest action = module_action(identity, stage.shader->options, stage.stage, text);
                const auto [at, fresh] = known.emplace(action, units_.size());
                if (fresh) units_.push_back({stage.stage, stage.shader->options, text, action, {}, false, {}, {}, {}});
                units_[at->second].classes.emplace_back(s, c);
                unit_of_[s].push_back(at->second);
            }
        }
    }

    std::optional<Bytes> get(Keyspace space, const Digest& key) {
        Result<std::optional<Bytes>> got = store_.get(space, key);
        if (got.ok()) return std::move(*got);
        store_failed(got.error());
        return std::nullopt;
    }

    void put(Keyspace space, const Digest& key, ByteView bytes) {
        const Status done = store_.put(space, key, bytes);
        if (!done.ok()) store_failed(done.error());
    }

    void store_failed(const Error& error) {
        const std::lock_guard lock(mutex_);
        if (out_.store_failures++ == 0) store_problem_ = error.message;
    }

    // A blob of words whose content has the name it was asked by, else null.
    SharedWords get_words(const Digest& digest) {
        const std::optional<Bytes> bytes = get(Keyspace::blob, digest);
        if (!bytes || bytes->empty() || bytes->size() % sizeof(uint32_t) != 0 || sha256(*bytes) != digest) return nullptr;
        Words words(bytes->size() / sizeof(uint32_t));
        std::memcpy(words.data(), bytes->data(), bytes->size());
        return pool_.keep(std::move(words));
    }

    // Records first; then each distinct module once, with one unoptimised form for each.
    bool look_up() {
        std::vector<Digest> asked;
        for (const Unit& unit : units_) asked.push_back(unit.action);
        if (elsewhere_) {
            std::vector<ModuleQuestion> questions;
            for (const Unit& unit : units_) questions.push_back({unit.stage, unit.options, unit.text, unit.action});
            elsewhere_->modules(questions);
        }
        store_.expect(asked);
        if (!jobs_.each(units_.size(), [&](size_t i) {
                Unit& unit = units_[i];
                const std::optional<Bytes> bytes = get(Keyspace::action, unit.action);
                if (!bytes) return;
                std::optional<ModuleRecord> record = read_module_record(unit.action, *bytes);
                if (!record) return;
                unit.record = std::move(*record);
                unit.hit = true;
            }))
            return false;
        std::map<Digest, std::vector<size_t>> of_module;
        for (size_t i = 0; i < units_.size(); ++i) {
            if (units_[i].hit) of_module[units_[i].record.module].push_back(i);
        }
        std::vector<const std::vector<size_t>*> wanted;
        for (const auto& [digest, units] : of_module) wanted.push_back(&units);
        return jobs_.each(wanted.size(), [&](size_t w) {
            const std::vector<size_t>& units = *wanted[w];
            const SharedWords final = get_words(units_[units.front()].record.module);
            const SharedWords pruned = final ? get_words(units_[units.front()].record.pruned) : nullptr;
            for (const size_t i : units) {
                units_[i].final = final;
                units_[i].hit = final && pruned;
            }
            units_[units.front()].pruned = pruned;
        });
    }

    bool compile() {
        std::vector<size_t> misses;
        for (size_t i = 0; i < units_.size(); ++i) {
            if (!units_[i].hit)
                misses.push_back(i);
            else
                out_.cache_hits += units_[i].classes.size();
        }
        out_.compiled = misses.size();
        Ticker ticker(progress_, "compile", misses.size());
        const bool complete = jobs_.each(misses.size(), [&](size_t m) {
            compile_one(units_[misses[m]]);
            ticker.tick();
        });
        failed_ = std::any_of(units_.begin(), units_.end(), [](const Unit& u) { return has_error(u.record.messages); });
        return complete;
    }

    void compile_one(Unit& unit) {
        unit.record = ModuleRecord();
        Compiled compiled = tools_.compile(unit.stage, unit.text, unit.options);
        unit.record.messages = std::move(compiled.messages);
        if (has_error(unit.record.messages)) return;
        unit.record.raw = digest_of(compiled.words);
        Result<Words> pruned = tools_.prune(compiled.words, unit.options);
        if (!pruned.ok()) {
            unit.record.messages.push_back({Severity::error, 0, pruned.error().message});
            return;
        }
        unit.record.pruned = digest_of(*pruned);
        unit.pruned = pool_.keep(std::move(*pruned));
    }

    // Optimises and validates each distinct pruned module of a miss, unless a hit already says what becomes of it.
    bool optimise() {
        std::map<std::pair<Digest, Digest>, SharedWords> known;  // (pruned, module's options) -> final
        for (const Unit& unit : units_) {
            if (unit.hit) known[{unit.record.pruned, options_key(unit.options)}] = unit.final;
        }
        std::vector<Candidate> candidates;
        std::map<std::pair<Digest, Digest>, size_t> index;
        std::vector<std::pair<size_t, size_t>> waiting;  // (unit, candidate)
        for (size_t i = 0; i < units_.size(); ++i) {
            Unit& unit = units_[i];
            if (unit.hit) continue;
            const std::pair<Digest, Digest> key{unit.record.pruned, options_key(unit.options)};
            if (const auto at = known.find(key); at != known.end()) {
                unit.final = at->second;
                unit.record.module = digest_of(*unit.final);
                continue;
            }
            const auto [at, fresh] = index.emplace(key, candidates.size());
            if (fresh) candidates.push_back({&unit, unit.pruned, nullptr, unit.options, unit.record.pruned, {}, {}});
            waiting.emplace_back(i, at->second);
        }
        out_.optimised = candidates.size();
        Ticker ticker(progress_, "optimise", candidates.size());
        if (!jobs_.each(candidates.size(), [&](size_t i) {
                optimise_one(candidates[i]);
                ticker.tick();
            }))
            return false;
        for (const auto& [u, c] : waiting) {
            Unit& unit = units_[u];
            const Candidate& candidate = candidates[c];
            unit.final = candidate.final;
            unit.record.module = candidate.final_digest;
            unit.record.messages.insert(unit.record.messages.end(), candidate.messages.begin(), candidate.messages.end());
            failed_ = failed_ || has_error(candidate.messages);
        }
        return true;
    }

    void optimise_one(Candidate& candidate) {
        Result<Words> final = tools_.optimise(*candidate.pruned, candidate.options);
        if (!final.ok()) {
            candidate.messages.push_back({Severity::error, 0, final.error().message});
            return;
        }
        candidate.messages = tools_.validate(*final, candidate.options);
        std::erase_if(candidate.messages, [](const ToolMessage& m) { return m.severity != Severity::error; });
        if (!candidate.messages.empty()) {
            say_whose_mistake(candidate);
            return;
        }
        candidate.final_digest = digest_of(*final);
        candidate.final = pool_.keep(std::move(*final));
    }

    // What glslang translates to invalid SPIR-V is the shader's: it checks less than Vulkan
    // asks.
    void say_whose_mistake(Candidate& candidate) {
        std::string whose = "internal error: optimising made an invalid module: ";
        if (has_error(tools_.validate(*candidate.pruned, candidate.options))) {
            const Compiled again = tools_.compile(candidate.unit->stage, candidate.unit->text, candidate.options);
            std::vector<ToolMessage> raw = tools_.validate(again.words, candidate.options);
            std::erase_if(raw, [](const ToolMessage& m) { return m.severity != Severity::error; });
            whose = raw.empty() ? "internal error: pruning made an invalid module: " : "no valid SPIR-V comes of this: ";
            if (!raw.empty()) candidate.messages = std::move(raw);
        }
        for (ToolMessage& m : candidate.messages) m.text = whose + m.text;
    }

    // Numbers the modules in order of first use and reflects those that no record describes.
    bool gather() {
        std::map<const Words*, uint32_t> number;
        std::vector<const Unit*> first;
        std::vector<uint32_t> of_unit;
        std::map<Digest, bool> raw, pruned;
        for (const Unit& unit : units_) {
            const auto [at, fresh] = number.emplace(unit.final.get(), static_cast<uint32_t>(first.size()));
            if (fresh) first.push_back(&unit);
            of_unit.push_back(at->second);
            raw[unit.record.raw] = pruned[unit.record.pruned] = true;
        }
        out_.raw = raw.size();
        out_.pruned = pruned.size();
        std::vector<Module> list(first.size());
        std::vector<std::string> problems(first.size());
        const bool complete = jobs_.each(first.size(), [&](size_t i) {
            const Unit& unit = *first[i];
            Module& module = list[i];
            module.stage = unit.stage;
            module.words = *unit.final;
            module.unoptimised = unit.pruned ? *unit.pruned : Words();
            module.digest = unit.record.module;
            if (unit.hit) {
                module.reflection = unit.record.reflection;
                return;
            }
            Result<Reflection> reflection = tools_.reflect(module.words);
            if (reflection.ok())
                module.reflection = std::move(*reflection);
            else
                problems[i] = "internal error: reflection: " + reflection.error().message;
        });
        for (size_t u = 0; u < units_.size() && complete; ++u) {
            const std::string& problem = problems[of_unit[u]];
            if (!problem.empty()) units_[u].record.messages.push_back({Severity::error, 0, problem});
            failed_ = failed_ || !problem.empty();
        }
        if (!complete || failed_) return complete;
        for (size_t u = 0; u < units_.size(); ++u) units_[u].record.reflection = list[of_unit[u]].reflection;
        out_.list = std::move(list);
        out_.of_class.resize(stages_.size());
        for (size_t s = 0; s < stages_.size(); ++s) {
            for (const size_t unit : unit_of_[s]) out_.of_class[s].push_back(of_unit[unit]);
        }
        return true;
    }

    // Blobs before the records that name them, so that a reader never finds a record without its blobs.
    bool remember() {
        if (!store_.keeps()) return true;
        std::map<Digest, const Words*> blobs;
        std::vector<const Unit*> fresh;
        for (const Unit& unit : units_) {
            if (unit.hit) continue;
            fresh.push_back(&unit);
            blobs[unit.record.pruned] = unit.pruned.get();
            blobs[unit.record.module] = unit.final.get();
        }
        const std::vector<std::pair<Digest, const Words*>> list(blobs.begin(), blobs.end());
        const bool complete =
            jobs_.each(list.size(), [&](size_t i) { put(Keyspace::blob, list[i].first, as_bytes(WordView(*list[i].second))); });
        return complete && jobs_.each(fresh.size(), [&](size_t i) {
            const ModuleRecord& record = fresh[i]->record;
            const Digest needs[] = {record.pruned, record.module};
            const Status done = store_.put_record(fresh[i]->action, write_module_record(fresh[i]->action, record), needs);
            if (!done.ok()) store_failed(done.error());
        });
    }

    void report() {
        std::vector<ClassMessage> messages;
        for (const Unit& unit : units_) {
            for (const auto& [s, c] : unit.classes) {
                for (const ToolMessage& m : unit.record.messages) messages.push_back({s, c, m});
            }
        }
        out_.diags = blame(stages_, messages, lines_, !complete_);
        if (out_.store_failures != 0) {
            out_.diags.warning(
                {}, "the cache failed " + std::to_string(out_.store_failures) + " times and was done without: " + store_problem_);
        }
        if (!complete_ || failed_) {
            out_.list.clear();
            out_.of_class.clear();
        }
    }

    static Digest options_key(const Options& options) { return module_action({}, options, Stage::vertex, {}); }

    const std::vector<StageClasses>& stages_;
    Store& store_;
    Toolchain& tools_;
    const Jobs& jobs_;
    const Progress& progress_;
    const SourceLines& lines_;
    Elsewhere* const elsewhere_;

    std::vector<Unit> units_;
    std::vector<std::vector<size_t>> unit_of_;  // [stage][class]
    WordPool pool_;
    std::mutex mutex_;  // store failures
    std::string store_problem_;
    bool complete_ = true;  // false: interrupted
    bool failed_ = false;   // some class has an error
    Modules out_;
};

}  // namespace

Modules build_modules(const std::vector<StageClasses>& stages, Store& store, Toolchain& tools, const Jobs& jobs,
                      const Progress& progress, const SourceLines& lines, Elsewhere* elsewhere) {
    return Builder(stages, store, tools, jobs, progress, lines, elsewhere).run();
}

}  // namespace kiln
