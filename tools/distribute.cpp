#include "tools/distribute.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>

#include "compiler/batch/batch.h"

namespace kiln {
namespace {

constexpr double batch_ms = 500;
// Of one processor, about; they decide how the work is cut, not what comes out.
constexpr double module_ms = 5, text_ms = 0.5;

uint64_t cuts(double total_ms, uint64_t workers) {
    const double most = std::floor(total_ms / batch_ms);
    return static_cast<uint64_t>(std::clamp(most, 1.0, static_cast<double>(2 * std::max<uint64_t>(workers, 1))));
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

uint64_t batches_for(uint64_t questions, double ms_each, uint64_t workers) {
    return questions == 0 ? 0 : std::min(questions, cuts(static_cast<double>(questions) * ms_each, workers));
}

double modelled_ms(uint64_t questions, double ms_each, uint64_t bytes, uint64_t workers, const DistributionModel& model) {
    const uint64_t batches = batches_for(questions, ms_each, workers);
    if (batches == 0) return 0;
    const double rounds = std::ceil(static_cast<double>(batches) / static_cast<double>(workers));
    const double work = static_cast<double>(questions) * ms_each / static_cast<double>(batches);
    return rounds * (model.action_ms + model.start_ms + work) + static_cast<double>(bytes) / model.bytes_a_ms;
}

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
    for (const auto part : cut(open, batches_for(open.size(), module_ms, engine_.width()))) {
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
    const double each = text_ms * static_cast<double>(texts) / static_cast<double>(open.size());
    std::vector<Bytes> batches;
    std::vector<std::vector<Digest>> asked;
    for (const auto part : cut(open, batches_for(open.size(), each, engine_.width()))) {
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
    module_step.bytes += write_batch(versions_, questions, {}).size();
}

void DistributionPlan::artifacts(std::span<const ArtifactQuestion> questions) {
    artifact_step.questions += questions.size();
    artifact_step.bytes += write_batch(versions_, {}, questions).size();
}

}  // namespace kiln
