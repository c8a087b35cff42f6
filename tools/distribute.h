#pragma once
// Sends a pass's questions to an engine in batches and puts the answers into the store; or only says what it would send.

#include <chrono>
#include <memory>
#include <string>

#include "cache/execute/engine.h"
#include "compiler/base/store.h"
#include "compiler/modules/elsewhere.h"

namespace kiln {

// What a batch costs beside its work, as measured with buildbox-casd: an action, and a worker's start.
struct DistributionModel {
    double action_ms = 90;
    double start_ms = 80;
    double bytes_a_ms = 100'000;  // 100 MB/s
};

struct DistributionCounts {
    uint64_t questions = 0;  // that the store had no answer to
    uint64_t batches = 0, failed_batches = 0, cached_batches = 0;
    uint64_t answered = 0;
    uint64_t bytes_out = 0, bytes_in = 0;  // of batches and answers; the worker travels once more
    std::string first_problem;
};

class Distributor final : public Elsewhere {
public:
    // The worker's program is read from `worker`. `engine`, `store` and `tools` outlive this object.
    static Result<std::unique_ptr<Distributor>> make(Engine& engine, Store& store, Toolchain& tools, const std::string& worker,
                                                     std::chrono::milliseconds deadline);
    void modules(std::span<const ModuleQuestion> questions) override;
    void artifacts(std::span<const ArtifactQuestion> questions) override;
    const DistributionCounts& counts() const { return counts_; }
    std::function<void(const char* what, size_t done, size_t total)> progress;

private:
    Distributor(Engine& engine, Store& store, Toolchain& tools, JobFile worker, std::chrono::milliseconds deadline)
        : engine_(engine), store_(store), tools_(tools), worker_(std::move(worker)), deadline_(deadline) {}
    void send(const char* what, std::vector<Bytes> batches, const std::vector<std::vector<Digest>>& asked);

    Engine& engine_;
    Store& store_;
    Toolchain& tools_;
    const JobFile worker_;
    const std::chrono::milliseconds deadline_;
    DistributionCounts counts_;
};

// Notes the questions, leaves all of the work at home and times nothing itself: the plan takes the pass's own times.
class DistributionPlan final : public Elsewhere {
public:
    explicit DistributionPlan(std::string versions) : versions_(std::move(versions)) {}
    void modules(std::span<const ModuleQuestion> questions) override;
    void artifacts(std::span<const ArtifactQuestion> questions) override;

    struct Step {
        const char* name = "";
        uint64_t questions = 0, bytes = 0;
    };
    Step module_step{"modules"}, artifact_step{"artifacts"};

private:
    const std::string versions_;
};

// How `questions` of `ms_each` fall into batches of at least half a second, two a worker where there is enough work.
uint64_t batches_for(uint64_t questions, double ms_each, uint64_t workers);
// The time of one step on so many workers, in ms.
double modelled_ms(uint64_t questions, double ms_each, uint64_t bytes, uint64_t workers, const DistributionModel& model);

}  // namespace kiln
