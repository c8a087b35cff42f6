#pragma once
// Runs commands somewhere else. A job is a command with the files that it reads, in a folder of its own that holds nothing
// else; it is a pure function of those, so an engine may answer it from a cache or run it twice.

#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/base/result.h"

namespace kiln {

struct JobFile {
    std::string path;  // relative, below the job's folder
    std::shared_ptr<const Bytes> bytes;
    Digest digest;  // of the bytes
    bool executable = false;
};

struct Job {
    std::vector<JobFile> inputs;
    std::vector<std::string> arguments;  // the program first, by a path below the folder: "./worker"
    std::vector<std::string> outputs;    // paths of files that must be there when it has ended with 0
};

struct JobResult {
    std::vector<Bytes> outputs;  // as Job::outputs
    bool cached = false;         // answered without running it
};

class Engine {
public:
    virtual ~Engine() = default;
    virtual std::string name() const = 0;  // "local", "grpc://…", for messages
    // How many jobs are worth having in flight.
    virtual size_t width() const = 0;
    // Blocks for at most `deadline`. An Error when the command failed, an output is missing or too large, or the engine could not
    // be had: nothing is known then, and the caller does the work itself. Thread-safe.
    virtual Result<JobResult> run(const Job& job, std::chrono::milliseconds deadline) = 0;
    // All of them, as many at once as width() says; results in the order of the jobs. `done` is called after each.
    virtual std::vector<Result<JobResult>> run_all(std::span<const Job> jobs, std::chrono::milliseconds deadline,
                                                   const std::function<void()>& done);
};

// Somebody else's words for a person: one line of at most 300 characters, without what a terminal would obey.
std::string one_line(std::string_view text);

// No output that comes back may be larger.
constexpr uint64_t largest_output = uint64_t{256} << 20;

}  // namespace kiln
