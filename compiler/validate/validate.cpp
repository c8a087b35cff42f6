// Collect, look up, run, sum up. Distinct pipelines are few beside the variants that they stand for, so everything here is a
// list over pipelines; conditions are made only for those that a person will see.

#include "compiler/validate/validate.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "compiler/space/describe.h"
#include "compiler/validate/check_wire.h"
#include "compiler/validate/validate_tasks.h"

namespace kiln {

namespace {

std::string where(const Task& t) {
    Space& space = t.shader->space;
    Set set = space.needed;
    for (size_t i = 0; i < t.pipeline->modules.size(); ++i)
        set = space.diagram->both(set, t.shader->variants_of(i, t.pipeline->modules[i]));
    return describe_condition(space, set, space.needed);
}

Result<std::vector<Task>> collect(TableView& table, const Proof* proof, const ValidateOptions& options, Toolchain& tools,
                                  ValidateReport& report) {
    std::vector<std::pair<TableShader*, const TablePipeline*>> there;
    bool found = options.shader.empty();
    for (TableShader& s : table.shaders()) {
        if (!options.shader.empty() && s.space.shader != options.shader) continue;
        found = true;
        for (const TablePipeline& p : s.pipelines) there.push_back({&s, &p});
    }
    if (!found) {
        std::vector<std::string> names;
        for (const TableShader& s : table.shaders()) names.push_back(s.space.shader);
        const std::string near = nearest(options.shader, names);
        return Error{Fault::input, "the table has no shader '" + options.shader + "'" +
                                       (near.empty() ? "" : " (did you mean '" + near + "'?)")};
    }
    report.pipelines_there = there.size();
    std::vector<std::vector<uint32_t>> tuples;
    std::set<uint32_t> modules;
    for (const auto& [shader, pipeline] : there) {
        tuples.push_back(pipeline->modules);
        modules.insert(pipeline->modules.begin(), pipeline->modules.end());
    }
    report.modules_there = modules.size();
    modules.clear();
    TaskMaker maker(table, proof, tools);
    std::vector<Task> tasks;
    for (const size_t i : choose_sample(tuples, options.sample == 0 ? there.size() : options.sample, options.seed)) {
        const auto& [shader, pipeline] = there[i];
        Result<Task> task = maker.make(*shader, *pipeline);
        KILN_TRY(task);
        task->job.seed = options.seed;
        task->job.size = options.size;
        tasks.push_back(std::move(*task));
        modules.insert(pipeline->modules.begin(), pipeline->modules.end());
        report.variants += Count::parse(pipeline->count);
    }
    report.modules = modules.size();
    report.pipelines = tasks.size();
    return tasks;
}

void sum_up(const Task& t, const Verdict& v, ValidateReport& report) {
    const auto finding = [&](std::string why) {
        return Finding{t.shader->space.shader, t.shader->space.describe_variant(t.pipeline->witness), where(t), std::move(why)};
    };
    if (v.nonfinite != 0) ++report.nonfinite;
    report.values += v.values;
    report.device_ms += v.ms;
    if (!v.compared) ++report.not_compared;
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

Result<ValidateReport> validate(ByteView table_bytes, ByteView proof_bytes, const ValidateOptions& options, WorkerPool& pool,
                                Store& store, Toolchain& tools, const Progress& progress) {
    Result<std::unique_ptr<TableView>> table = TableView::open(table_bytes);
    KILN_TRY(table);
    ValidateReport report;
    report.device = pool.info();
    std::optional<Proof> proof;
    if (!proof_bytes.empty()) {
        Result<Proof> read = read_proof(proof_bytes, table_bytes);
        KILN_TRY(read);
        proof = std::move(*read);
        for (const ProofMismatch& m : check_proof(**table, *proof))
            if (options.shader.empty() || m.shader == options.shader)
                report.failed.push_back({m.shader, m.variant, "in variants of " + m.shader, m.why});
    }
    Result<std::vector<Task>> tasks = collect(**table, proof ? &*proof : nullptr, options, tools, report);
    KILN_TRY(tasks);

    std::vector<Digest> keys;
    std::map<Digest, Verdict> verdicts;
    std::set<Digest> seen;  // tasks may be equal in everything: the first is run
    std::vector<size_t> to_run;
    for (size_t i = 0; i < tasks->size(); ++i) {
        const Digest key = keys.emplace_back(verdict_key(report.device, (*tasks)[i].job));
        if (!seen.insert(key).second) {
            ++report.shared;
            continue;
        }
        const Result<std::optional<Bytes>> kept = store.get(Keyspace::action, key);
        if (!kept.ok()) ++report.store_failures;
        std::optional<Verdict> verdict = kept.ok() && kept.value().has_value() ? decode_verdict(*kept.value()) : std::nullopt;
        if (verdict)
            verdicts[key] = std::move(*verdict);
        else
            to_run.push_back(i);
    }
    report.cached = verdicts.size();
    size_t done = tasks->size() - to_run.size();
    if (progress) progress("validate", done, tasks->size());
    KILN_TRY(pool.run(
        to_run.size(), [&](size_t i) { return (*tasks)[to_run[i]].job; },
        [&](size_t i, const Verdict& verdict, bool cacheable) {
            const Digest& key = keys[to_run[i]];
            verdicts[key] = verdict;
            ++report.run;
            if (cacheable && !store.put(Keyspace::action, key, encode(verdict)).ok()) ++report.store_failures;
            if (progress) progress("validate", ++done, tasks->size());
        }));
    for (size_t i = 0; i < tasks->size(); ++i) sum_up((*tasks)[i], verdicts[keys[i]], report);

    const auto by_variant = [](const Finding& a, const Finding& b) {
        return std::tie(a.shader, a.variant, a.why) < std::tie(b.shader, b.variant, b.why);
    };
    for (std::vector<Finding>* list : {&report.failed, &report.unsupported, &report.undrawn})
        std::stable_sort(list->begin(), list->end(), by_variant);
    return report;
}

}  // namespace kiln
