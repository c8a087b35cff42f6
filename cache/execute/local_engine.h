#pragma once
// Jobs as processes of this machine, each in a folder of its own: the engine of tests, and of a machine whose jobs a sandbox
// or a limit should keep apart.

#include <atomic>

#include "cache/execute/engine.h"

namespace kiln {

class LocalEngine final : public Engine {
public:
    explicit LocalEngine(size_t width) : width_(width) {}
    std::string name() const override { return "local:" + std::to_string(width_); }
    size_t width() const override { return width_; }
    Result<JobResult> run(const Job& job, std::chrono::milliseconds deadline) override;

private:
    const size_t width_;
};

// Lays a job's inputs out below `folder`, which exists; refuses paths that leave it.
Status write_inputs(const Job& job, const std::string& folder);
// Reads the outputs back; an Error when one is missing, no regular file or too large.
Result<JobResult> read_outputs(const Job& job, const std::string& folder);

// A folder that is removed with all that is in it.
class ScratchFolder {
public:
    static Result<std::unique_ptr<ScratchFolder>> make(const std::string& below);
    ~ScratchFolder();
    const std::string& path() const { return path_; }

private:
    explicit ScratchFolder(std::string path) : path_(std::move(path)) {}
    const std::string path_;
};

// Runs a program in a folder until it ends, or until the deadline passes or `stop` is set, when it is killed with all that it has
// started. Its output goes to `log`. The exit code, or an Error: could not start, killed, out of time.
Result<int> run_process(const std::vector<std::string>& arguments, const std::string& folder, const std::string& log,
                        std::chrono::milliseconds deadline, const std::atomic<bool>* stop);

// What a failed job's log ends with, for a message: ": the last words", or nothing.
std::string last_words(const std::string& log);

}  // namespace kiln
