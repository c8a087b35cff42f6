#pragma once
// Runs checks in worker processes, so that a driver that crashes or hangs takes one pipeline with it and not the run. A
// worker is any command that ends in run_worker(): the command line's hidden verb, a test's own program.
//
// Both sides talk in frames (u64 length, then a record of check_wire.h) over one socket, the worker's standard input. What a
// worker prints is kept, and its end quoted when it dies.

#include <functional>
#include <string>
#include <vector>

#include "compiler/validate/check.h"

namespace kiln {

struct WorkerOptions {
    std::vector<std::string> command;  // program and arguments
    unsigned count = 0;                // processes; 0: one a core
    double timeout_seconds = 60;       // for one pipeline, wall clock; also for a worker to start
    uint32_t recycle_after = 1000;     // pipelines, then a new process: drivers leak
};

// Called in the order in which checks end. `cacheable`: the verdict would be the same again; false for a crash or time-out.
using CheckDone = std::function<void(size_t index, const Verdict& verdict, bool cacheable)>;

// Starts and stops with the object. Not for use from two threads.
class WorkerPool {
public:
    // Starts one worker and asks it for its device; its Error is that of the worker's device.
    static Result<std::unique_ptr<WorkerPool>> start(const WorkerOptions& options);
    virtual ~WorkerPool() = default;
    virtual const DeviceInfo& info() const = 0;
    // Checks all jobs. A pipeline whose worker crashed after others had run in it gets a second try in a fresh one. An Error
    // when no worker can be started any more or when `interrupted` was set: every worker is killed then.
    virtual Status run(size_t count, const std::function<CheckJob(size_t)>& job, const CheckDone& done) = 0;
};

// The other side: reads jobs until the socket closes. `open` makes the device. Returns the process's exit code.
int run_worker(const std::function<Result<std::unique_ptr<Device>>()>& open);

}  // namespace kiln
