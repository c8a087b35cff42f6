// Collect, look up, run, sum up. Distinct pipelines are few beside the variants that they stand for, so everything here is a
// list over pipelines; conditions are made only for those that a person will see.

#include "compiler/validate.h"

#include <algorithm>
#include <map>
#include <set>

#include "compiler/check_wire.h"
#include "compiler/describe.h"
#include "compiler/device/partner.h"
#include "compiler/device/values.h"
#include "compiler/proof.h"
#include "compiler/published.h"

namespace kiln {

namespace {

constexpr uint32_t partner_attachments = 8;  // what every Vulkan device of the desktop has

struct Task {
    uint32_t shader = 0, pipeline = 0;  // numbers in the table
    std::string name, variant;
    Count count;
    std::vector<uint32_t> modules;
    CheckJob job;
    Digest key;
};

class Collector {
public:
    Collector(const kiln_table& table, const Proof* proof, Toolchain& tools, const ValidateOptions& options)
        : table_(table), tools_(tools), options_(options) {
        if (proof != nullptr)
            for (const ProofModule& m : proof->modules) unoptimised_words_[m.digest] = &m.unoptimised;
    }
    Result<std::vector<Task>> collect(ValidateReport& report);

private:
    Result<StagePtr> optimised(const kiln_shader& shader, uint32_t module);
    Result<StagePtr> unoptimised(uint32_t module);
    Result<StagePtr> partner(Stage stage, const std::string& text, const std::vector<Varying>& outputs);
    Status add_partners(Task& task);

    const kiln_table& table_;
    Toolchain& tools_;
    const ValidateOptions& options_;
    std::map<Digest, const Words*> unoptimised_words_;
    std::map<std::pair<uint32_t, uint32_t>, StagePtr> optimised_;  // by shader, module: slots are a shader's
    std::map<uint32_t, StagePtr> unoptimised_;
    std::map<std::string, StagePtr> partners_;
};

Result<StagePtr> Collector::optimised(const kiln_shader& shader, uint32_t module) {
    StagePtr& known = optimised_[{shader.index, module}];
    if (known != nullptr) return known;
    Result<StageCode> stage = published_stage(table_, shader, module);
    KILN_TRY(stage);
    known = std::make_shared<const StageCode>(std::move(*stage));
    return known;
}

// Null when the proof has no unoptimised form.
Result<StagePtr> Collector::unoptimised(uint32_t module) {
    if (const auto known = unoptimised_.find(module); known != unoptimised_.end()) return known->second;
    kiln_module code;
    if (kiln_get_module(&table_, module, &code) != KILN_OK) return input_error("the table is damaged: no such module");
    Digest digest;
    std::copy(code.digest, code.digest + digest.bytes.size(), digest.bytes.begin());
    StagePtr out;
    const auto words = unoptimised_words_.find(digest);
    if (words != unoptimised_words_.end() && !words->second->empty()) {
        StageCode stage;
        stage.words = *words->second;
        Result<Reflection> reflection = tools_.reflect(stage.words);
        KILN_TRY(reflection);
        stage.reflection = std::move(*reflection);
        stage.stage = stage.reflection.stage;
        out = std::make_shared<const StageCode>(std::move(stage));
    }
    unoptimised_[module] = out;
    return out;
}

Result<StagePtr> Collector::partner(Stage stage, const std::string& text, const std::vector<Varying>& outputs) {
    StagePtr& known = partners_[text];
    if (known != nullptr) return known;
    const Compiled compiled = tools_.compile(stage, text, Options());
    if (compiled.words.empty())
        return environment_error(std::string("a generated ") + name_of(stage) + " stage does not compile: " +
                                 (compiled.messages.empty() ? "no message" : compiled.messages.front().text));
    StageCode code;
    code.stage = stage;
    code.words = compiled.words;
    code.partner = true;
    code.reflection.stage = stage;
    code.reflection.outputs = outputs;
    known = std::make_shared<const StageCode>(std::move(code));
    return known;
}

const StageCode* find_stage(const std::vector<StagePtr>& stages, Stage stage) {
    for (const StagePtr& s : stages)
        if (s->stage == stage) return s.get();
    return nullptr;
}

Status Collector::add_partners(Task& task) {
    std::vector<StagePtr>& stages = task.job.optimised;
    if (stages.empty() || stages.front()->stage == Stage::compute || stages.front()->stage >= Stage::raygen) return {};
    const StageCode* fragment = find_stage(stages, Stage::fragment);
    StagePtr added;
    if (fragment != nullptr && stages.size() == 1) {
        // Both forms get one partner, so it feeds what either of them declares.
        std::vector<Varying> inputs = fragment->reflection.inputs;
        if (const StageCode* other = find_stage(task.job.unoptimised, Stage::fragment))
            for (const Varying& v : other->reflection.inputs)
                if (std::none_of(inputs.begin(), inputs.end(),
                                 [&](const Varying& i) { return i.location == v.location && i.component == v.component; }))
                    inputs.push_back(v);
        Result<StagePtr> made = partner(Stage::vertex, vertex_partner(inputs), inputs);
        KILN_TRY(made);
        added = *made;
    } else if (fragment == nullptr) {
        const std::vector<Varying>& outputs = stages.back()->reflection.outputs;
        const std::string text = fragment_partner(outputs, partner_attachments);
        std::vector<Varying> written;  // one a location, four components at most: what fragment_partner() declares
        for (const Varying& v : outputs) {
            if (v.type.base == BaseType::float16 || v.type.base == BaseType::float64) continue;
            uint32_t n = v.type.columns;
            for (const uint32_t dim : v.type.array) n = std::min(64u, n * std::max(1u, dim));
            for (uint32_t i = 0; i < n && written.size() < partner_attachments; ++i) {
                Varying w = v;
                w.location = static_cast<uint32_t>(written.size());
                w.component = 0;
                w.type.columns = 1;
                w.type.array.clear();
                written.push_back(std::move(w));
            }
        }
        Result<StagePtr> made = partner(Stage::fragment, text, written);
        KILN_TRY(made);
        added = *made;
    }
    if (added == nullptr) return {};
    for (std::vector<StagePtr>* form : {&task.job.optimised, &task.job.unoptimised})
        if (!form->empty()) form->insert(added->stage == Stage::vertex ? form->begin() : form->end(), added);
    return {};
}

Result<std::vector<Task>> Collector::collect(ValidateReport& report) {
    std::vector<Task> tasks;
    kiln_info info;
    if (kiln_get_info(&table_, &info) != KILN_OK) return input_error("the table is damaged: no information record");
    bool found = options_.shader.empty();
    for (uint32_t s = 0; s < info.shader_count; ++s) {
        kiln_shader shader;
        if (kiln_get_shader(&table_, s, &shader) != KILN_OK) return input_error("the table is damaged: no such shader");
        const std::string name = text_of(shader.name);
        if (!options_.shader.empty() && name != options_.shader) continue;
        found = true;
        for (uint32_t p = 0; p < shader.pipeline_count; ++p) {
            kiln_pipeline pipeline;
            if (kiln_get_pipeline(&shader, p, &pipeline) != KILN_OK) return input_error("the table is damaged: no such pipeline");
            Task t;
            t.shader = s;
            t.pipeline = p;
            t.name = name;
            t.variant = published_variant(shader, pipeline.witness);
            t.count = Count::parse(text_of(pipeline.count));
            t.modules.assign(pipeline.modules, pipeline.modules + shader.stage_count);
            tasks.push_back(std::move(t));
        }
    }
    if (!found) return input_error("the table has no shader '" + options_.shader + "'");
    report.pipelines_there = tasks.size();
    std::set<uint32_t> modules;
    for (const Task& t : tasks) modules.insert(t.modules.begin(), t.modules.end());
    report.modules_there = modules.size();
    if (options_.sample != 0) {
        std::vector<std::vector<uint32_t>> tuples;
        for (const Task& t : tasks) tuples.push_back(t.modules);
        std::vector<Task> chosen;
        for (const size_t i : choose_sample(tuples, options_.sample, options_.seed)) chosen.push_back(std::move(tasks[i]));
        tasks = std::move(chosen);
        modules.clear();
        for (const Task& t : tasks) modules.insert(t.modules.begin(), t.modules.end());
    }
    report.modules = modules.size();
    report.pipelines = tasks.size();
    for (Task& t : tasks) {
        report.variants += t.count;
        kiln_shader shader;
        if (kiln_get_shader(&table_, t.shader, &shader) != KILN_OK) return input_error("the table is damaged: no such shader");
        bool compared = true;
        for (const uint32_t module : t.modules) {
            Result<StagePtr> stage = optimised(shader, module);
            KILN_TRY(stage);
            t.job.optimised.push_back(*stage);
            Result<StagePtr> other = unoptimised(module);
            KILN_TRY(other);
            compared &= *other != nullptr;
            t.job.unoptimised.push_back(*other);
        }
        if (!compared) t.job.unoptimised.clear();
        t.job.seed = options_.seed;
        t.job.size = options_.size;
        KILN_TRY(add_partners(t));
    }
    return tasks;
}

// Says which variants a pipeline stands for. With a proof exactly, by intersecting its stages' classes; else by example.
class Naming {
public:
    Naming(const kiln_table& table, Proof* proof) : table_(table), proof_(proof) {}
    std::string where(const Task& t);

private:
    Space* space_of(const Task& t);
    const kiln_table& table_;
    Proof* proof_;
    std::map<uint32_t, std::unique_ptr<Space>> spaces_;  // borrow the proof's diagrams
};

Space* Naming::space_of(const Task& t) {
    std::unique_ptr<Space>& space = spaces_[t.shader];
    if (space != nullptr) return space.get();
    ProofShader* recorded = nullptr;
    if (proof_ != nullptr)
        for (ProofShader& s : proof_->shaders)
            if (s.name == t.name) recorded = &s;
    kiln_shader shader;
    if (recorded == nullptr || recorded->diagram == nullptr || recorded->stages.empty() ||
        kiln_get_shader(&table_, t.shader, &shader) != KILN_OK)
        return nullptr;
    space = std::make_unique<Space>();
    space->shader = t.name;
    space->axes = published_axes(shader);
    space->diagram = std::move(recorded->diagram);
    space->needed = Diagram::none();
    for (const ProofClass& c : recorded->stages.front().classes)
        space->needed = space->diagram->either(space->needed, c.variants);
    space->legal = space->needed;
    return space.get();
}

std::string Naming::where(const Task& t) {
    Space* space = space_of(t);
    if (space == nullptr) {
        std::string total;
        kiln_shader shader;
        if (kiln_get_shader(&table_, t.shader, &shader) == KILN_OK) total = Count::parse(text_of(shader.needed)).grouped();
        return "in " + t.count.grouped() + " of " + total + " variants of " + t.name + ": for example " + t.variant;
    }
    Set set = space->needed;
    for (const ProofShader& s : proof_->shaders) {
        if (s.name != t.name) continue;
        for (size_t i = 0; i < s.stages.size() && i < t.modules.size(); ++i) {
            Set of_module = Diagram::none();
            for (const ProofClass& c : s.stages[i].classes)
                if (c.module == t.modules[i]) of_module = space->diagram->either(of_module, c.variants);
            set = space->diagram->both(set, of_module);
        }
    }
    return describe_condition(*space, set, space->needed);
}

void sum_up(const Task& t, const Verdict& v, Naming& naming, ValidateReport& report) {
    const auto finding = [&](std::string why) { return Finding{t.name, t.variant, naming.where(t), std::move(why)}; };
    if (v.nonfinite != 0) ++report.nonfinite;
    report.values += v.values;
    report.device_ms += v.ms;
    switch (v.outcome) {
        case Outcome::failed:
            report.failed.push_back(finding(v.why));
            return;
        case Outcome::unsupported:
            report.unsupported.push_back(finding(v.why));
            return;
        case Outcome::passed:
            break;
    }
    ++report.passed;
    if (!v.compared) ++report.not_compared;
    if (v.covered == 0) report.undrawn.push_back(finding("drew no pixel"));
}

class LocalPool final : public WorkerPool {
public:
    explicit LocalPool(std::unique_ptr<Device> device) : device_(std::move(device)) {}
    const DeviceInfo& info() const override { return device_->info(); }
    Status run(size_t count, const std::function<CheckJob(size_t)>& job, const CheckDone& done) override {
        for (size_t i = 0; i < count; ++i) {
            if (interrupted) return environment_error("interrupted");
            const Result<Verdict> v = check_pipeline(*device_, job(i));
            KILN_TRY(v);
            done(i, *v, true);
        }
        return {};
    }

private:
    std::unique_ptr<Device> device_;
};

}  // namespace

std::unique_ptr<WorkerPool> local_pool(std::unique_ptr<Device> device) { return std::make_unique<LocalPool>(std::move(device)); }

std::vector<size_t> choose_sample(const std::vector<std::vector<uint32_t>>& pipelines, uint64_t wanted, uint64_t seed) {
    // The greedy cover, exactly: what a pipeline would add only ever shrinks, so a pass for each gain in falling order will do.
    size_t most = 0;
    for (const auto& p : pipelines) most = std::max(most, p.size());
    std::set<uint32_t> covered;
    std::vector<bool> taken(pipelines.size(), false);
    uint64_t count = 0;
    for (size_t gain = most; gain != 0; --gain)
        for (size_t i = 0; i < pipelines.size(); ++i) {
            if (taken[i]) continue;
            size_t fresh = 0;
            for (const uint32_t m : std::set<uint32_t>(pipelines[i].begin(), pipelines[i].end())) fresh += covered.count(m) == 0;
            if (fresh < gain) continue;
            taken[i] = true;
            ++count;
            covered.insert(pipelines[i].begin(), pipelines[i].end());
        }
    std::vector<std::pair<uint64_t, size_t>> rest;
    for (size_t i = 0; i < pipelines.size(); ++i)
        if (!taken[i]) rest.push_back({mix64(seed ^ mix64(i)), i});
    std::sort(rest.begin(), rest.end());
    for (size_t i = 0; i < rest.size() && count < wanted; ++i, ++count) taken[rest[i].second] = true;
    std::vector<size_t> out;
    for (size_t i = 0; i < taken.size(); ++i)
        if (taken[i]) out.push_back(i);
    return out;
}

Result<ValidateReport> validate(ByteView table_bytes, ByteView proof_bytes, const ValidateOptions& options, WorkerPool& pool,
                                Store& store, Toolchain& tools, const Progress& progress) {
    kiln_table table;
    const char* what = nullptr;
    if (const kiln_status s = kiln_open(&table, table_bytes.data(), table_bytes.size()); s != KILN_OK)
        return input_error(std::string("not a usable table: ") + kiln_status_text(s));
    if (kiln_verify(&table, &what) != KILN_OK)
        return input_error(std::string("the table is damaged") + (what == nullptr ? "" : std::string(": ") + what));
    ValidateReport report;
    report.device = pool.info();
    std::optional<Proof> proof;
    if (!proof_bytes.empty()) {
        Result<Proof> read = read_proof(proof_bytes, table_bytes);
        KILN_TRY(read);
        proof = std::move(*read);
        for (const ProofMismatch& m : check_proof(table_bytes, *proof))
            if (options.shader.empty() || m.shader == options.shader)
                report.failed.push_back({m.shader, m.variant, "in " + m.shader, m.why});
    }
    Proof* const known = proof ? &*proof : nullptr;
    Result<std::vector<Task>> tasks = Collector(table, known, tools, options).collect(report);
    KILN_TRY(tasks);

    std::map<Digest, Verdict> verdicts;
    std::vector<size_t> to_run;
    std::map<Digest, uint64_t> users;  // tasks that are equal in everything: the first is run
    for (size_t i = 0; i < tasks->size(); ++i) {
        Task& t = (*tasks)[i];
        t.key = verdict_key(report.device, t.job);
        if (users[t.key]++ != 0) {
            ++report.shared;
            continue;
        }
        const Result<std::optional<Bytes>> kept = store.get(Keyspace::action, t.key);
        if (!kept.ok()) ++report.store_failures;
        std::optional<Verdict> verdict = kept.ok() && kept.value().has_value() ? decode_verdict(*kept.value()) : std::nullopt;
        if (verdict)
            verdicts[t.key] = std::move(*verdict);
        else
            to_run.push_back(i);
    }
    report.cached = verdicts.size();
    size_t done = tasks->size() - to_run.size();
    if (progress) progress("validate", done, tasks->size());
    KILN_TRY(pool.run(
        to_run.size(), [&](size_t i) { return (*tasks)[to_run[i]].job; },
        [&](size_t i, const Verdict& verdict, bool cacheable) {
            const Digest& key = (*tasks)[to_run[i]].key;
            verdicts[key] = verdict;
            ++report.run;
            if (cacheable && !store.put(Keyspace::action, key, encode(verdict)).ok()) ++report.store_failures;
            if (progress) progress("validate", ++done, tasks->size());
        }));
    Naming naming(table, known);
    for (const Task& t : *tasks) sum_up(t, verdicts[t.key], naming, report);  // in the table's order, whatever the workers' was
    const auto by_variant = [](const Finding& a, const Finding& b) {
        return std::tie(a.shader, a.variant, a.why) < std::tie(b.shader, b.variant, b.why);
    };
    for (std::vector<Finding>* list : {&report.failed, &report.unsupported, &report.undrawn})
        std::sort(list->begin(), list->end(), by_variant);
    return report;
}

}  // namespace kiln
