#include "tools/distribute.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "compiler/batch/batch.h"

namespace kiln {
namespace {

constexpr double batch_ms = 500;

// Into how many batches of at least half a second, two a worker where there is enough work.
uint64_t cuts(uint64_t questions, double total_ms, uint64_t workers) {
    const double most = std::floor(total_ms / batch_ms);
    const double wanted = std::clamp(most, 1.0, static_cast<double>(2 * std::max<uint64_t>(workers, 1)));
    return std::min(questions, static_cast<uint64_t>(wanted));
}

template <class Question>
std::vector<std::span<const Question>> cut(const std::vector<Question>& questions, uint64_t parts) {
    std::vector<std::span<const Question>> out;
    const size_t count = questions.size();
    for (uint64_t i = 0; i < parts; ++i) {
        const size_t first = count * i / parts, last = count * (i + 1) / parts;
        if (first < last) out.emplace_back(questions.data() + first, last - first);
    }
    return out;
}

}  // namespace

Result<std::unique_ptr<Distributor>> Distributor::make(Engine& engine, Store& store, Toolchain& tools, const std::string& worker,
                                                       std::chrono::milliseconds deadline) {
    std::ifstream in(worker, std::ios::binary);
    auto bytes = std::make_shared<Bytes>(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    if (!in || bytes->empty()) return environment_error("the worker's program cannot be read: " + worker);
    const Digest digest = sha256(*bytes);
    return std::unique_ptr<Distributor>(
        new Distributor(engine, store, tools, JobFile{"kiln-worker", std::move(bytes), digest, true}, deadline));
}

void Distributor::modules(std::span<const ModuleQuestion> questions) {
    std::vector<ModuleQuestion> open;
    for (const ModuleQuestion& q : questions) {
        const auto there = store_.get(Keyspace::action, q.action);
        if (!there.ok() || !there->has_value()) open.push_back(q);
    }
    counts_.questions += open.size();
    std::vector<Bytes> batches;
    std::vector<std::vector<Digest>> asked;
    for (const auto part : cut(open, cuts(open.size(), module_ms * static_cast<double>(open.size()), engine_.width()))) {
        batches.push_back(write_batch(tools_.identity(), part, {}));
        for (asked.emplace_back(); const ModuleQuestion& q : part) asked.back().push_back(q.action);
    }
    send("batches compiled elsewhere", std::move(batches), asked);
}

void Distributor::artifacts(std::span<const ArtifactQuestion> questions) {
    std::vector<ArtifactQuestion> open;
    size_t texts = 0;
    for (const ArtifactQuestion& q : questions) {
        ArtifactQuestion left{q.words, q.slots, {}, {}};
        for (size_t t = 0; t < q.targets.size(); ++t) {
            const auto there = store_.get(Keyspace::action, q.actions[t]);
            if (there.ok() && there->has_value()) continue;
            left.targets.push_back(q.targets[t]);
            left.actions.push_back(q.actions[t]);
        }
        texts += left.targets.size();
        if (!left.targets.empty()) open.push_back(std::move(left));
    }
    counts_.questions += texts;
    if (open.empty()) return;
    std::vector<Bytes> batches;
    std::vector<std::vector<Digest>> asked;
    for (const auto part : cut(open, cuts(open.size(), text_ms * static_cast<double>(texts), engine_.width()))) {
        batches.push_back(write_batch(tools_.identity(), {}, part));
        asked.emplace_back();
        for (const ArtifactQuestion& q : part) asked.back().insert(asked.back().end(), q.actions.begin(), q.actions.end());
    }
    send("batches translated elsewhere", std::move(batches), asked);
}

void Distributor::send(const char* what, std::vector<Bytes> batches, const std::vector<std::vector<Digest>>& asked) {
    if (batches.empty()) return;
    std::vector<Job> jobs;
    for (Bytes& batch : batches) {
        counts_.bytes_out += batch.size();
        const Digest digest = sha256(batch);
        jobs.push_back({{worker_, {"batch", std::make_shared<const Bytes>(std::move(batch)), digest, false}},
                        {"./kiln-worker", "batch", "answers"},
                        {"answers"}});
    }
    counts_.batches += jobs.size();
    if (progress) progress(what, 0, jobs.size());
    std::atomic<size_t> ended{0};
    const std::vector<Result<JobResult>> results = engine_.run_all(jobs, deadline_, [&] {
        const size_t now = ++ended;
        if (progress) progress(what, now, jobs.size());
    });
    for (size_t i = 0; i < results.size(); ++i) {
        Result<size_t> taken = results[i].ok() ? take_answers(results[i]->outputs.front(), asked[i], store_) : results[i].error();
        if (taken.ok()) {
            counts_.answered += *taken;
            counts_.bytes_in += results[i]->outputs.front().size();
            counts_.cached_batches += results[i]->cached ? 1 : 0;
        } else if (counts_.failed_batches++ == 0) {
            counts_.first_problem = taken.error().message;
        }
    }
}

void DistributionPlan::modules(std::span<const ModuleQuestion> questions) {
    module_step.questions += questions.size();
    module_step.answers += questions.size();
    module_step.bytes_out += write_batch(identity_, questions, {}).size();
    const std::lock_guard lock(mutex_);
    for (const ModuleQuestion& q : questions) asked_[q.action] = &module_step;
}

void DistributionPlan::artifacts(std::span<const ArtifactQuestion> questions) {
    artifact_step.questions += questions.size();
    artifact_step.bytes_out += write_batch(identity_, {}, questions).size();
    const std::lock_guard lock(mutex_);
    for (const ArtifactQuestion& q : questions) {
        artifact_step.answers += q.actions.size();
        for (const Digest& action : q.actions) asked_[action] = &artifact_step;
    }
}

Status DistributionPlan::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (space == Keyspace::action) return put_record(key, bytes, {});
    const std::lock_guard lock(mutex_);
    blobs_.emplace(key, bytes.size());
    return {};
}

Status DistributionPlan::put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) {
    const std::lock_guard lock(mutex_);
    const auto step = asked_.find(key);
    if (step == asked_.end()) return {};
    step->second->bytes_in += record.size();
    for (const Digest& blob : blobs)
        if (const auto found = blobs_.find(blob); found != blobs_.end())
            step->second->bytes_in += std::exchange(found->second, 0);
    return {};
}

uint64_t DistributionPlan::Step::batches(uint64_t workers) const {
    return cuts(questions, static_cast<double>(answers) * answer_ms, workers);
}

double DistributionPlan::Step::ms(double work_ms, uint64_t workers, const DistributionModel& model) const {
    const auto count = static_cast<double>(batches(workers));
    if (count == 0) return 0;
    const double rounds = std::ceil(count / static_cast<double>(workers));
    return rounds * (model.action_ms + model.start_ms + work_ms / count) +
           static_cast<double>(bytes_out + bytes_in) / model.bytes_a_ms;
}

}  // namespace kiln
