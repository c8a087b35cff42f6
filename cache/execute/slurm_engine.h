#pragma once
// Jobs as one array of Slurm's: the batch-only way. All jobs of a step are laid out in a folder that the nodes share,
// submitted by one `sbatch --array --wait`, and read back when the array has ended.

#include "cache/execute/engine.h"

namespace kiln {

class SlurmEngine final : public Engine {
public:
    // `shared`: a folder that every node sees under this name; `options`: further words for sbatch ("--partition=short").
    SlurmEngine(std::string shared, std::vector<std::string> options);
    std::string name() const override { return "slurm:" + shared_; }
    // Twice as many batches are made, and Slurm's own bound of an array is a thousand (MaxArraySize).
    size_t width() const override { return 500; }
    Result<JobResult> run(const Job& job, std::chrono::milliseconds deadline) override;
    std::vector<Result<JobResult>> run_all(std::span<const Job> jobs, std::chrono::milliseconds deadline,
                                           const std::function<void()>& done) override;

private:
    const std::string shared_;
    const std::vector<std::string> options_;
};

}  // namespace kiln
