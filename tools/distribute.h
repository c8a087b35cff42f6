#pragma once
// Sends a pass's questions to an engine in batches and puts the answers into the store; or only says what it would send.

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
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

// Of one processor, about; they decide how the work is cut, not what comes out.
constexpr double module_ms = 5, text_ms = 0.5;

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

// Notes the questions and leaves all of the work at home. As the pass's store it notes what answers would weigh, and keeps
// nothing.
class DistributionPlan final : public Elsewhere, public Store {
public:
    explicit DistributionPlan(std::string identity) : identity_(std::move(identity)) {}
    void modules(std::span<const ModuleQuestion> questions) override;
    void artifacts(std::span<const ArtifactQuestion> questions) override;
    Result<std::optional<Bytes>> get(Keyspace, const Digest&) override { return std::optional<Bytes>(); }
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;
    Status put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) override;

    struct Step {
        const char* name = "";
        uint64_t questions = 0;  // classes, modules
        double answer_ms = 0;    // as batches are cut
        uint64_t answers = 0;    // that are asked for: of a module, one a text
        uint64_t bytes_out = 0, bytes_in = 0;
        uint64_t batches(uint64_t workers) const;
        // What it takes when a processor needs `work_ms` for all of it.
        double ms(double work_ms, uint64_t workers, const DistributionModel& model) const;
    };
    Step module_step{"modules", 0, module_ms}, artifact_step{"artifacts", 0, text_ms};

private:
    const std::string identity_;
    std::mutex mutex_;  // of what follows, and of bytes_in
    std::map<Digest, Step*> asked_;
    std::map<Digest, uint64_t> blobs_;  // their sizes, until they are counted
};

}  // namespace kiln
