// An array costs about a second to submit and another to notice its end, whatever is in it: whole steps are submitted, not jobs.

#include "cache/execute/slurm_engine.h"

#include <filesystem>
#include <fstream>

#include "cache/execute/local_engine.h"
#include "compiler/base/jobs.h"

namespace kiln {
namespace {

std::string quoted(const std::string& word) {
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

// Runs in the job's folder and leaves its exit code there, since an array has one code for all.
std::string script_of(const std::vector<std::string>& folders, std::span<const Job> jobs) {
    std::string out = "#!/bin/sh\ncase \"$SLURM_ARRAY_TASK_ID\" in\n";
    for (size_t i = 0; i < jobs.size(); ++i) {
        out += std::to_string(i) + ") cd " + quoted(folders[i]) + " || exit 1\n";
        for (const std::string& word : jobs[i].arguments) out += " " + quoted(word);
        out += " >log 2>&1\necho $? >code.tmp && mv code.tmp code ;;\n";
    }
    return out + "esac\n";
}

}  // namespace

SlurmEngine::SlurmEngine(std::string shared, std::vector<std::string> options)
    : shared_(std::move(shared)), options_(std::move(options)) {}

Result<JobResult> SlurmEngine::run(const Job& job, std::chrono::milliseconds deadline) {
    std::vector<Result<JobResult>> one = run_all({&job, 1}, deadline, {});
    return std::move(one.front());
}

std::vector<Result<JobResult>> SlurmEngine::run_all(std::span<const Job> jobs, std::chrono::milliseconds deadline,
                                                    const std::function<void()>& done) {
    const auto all = [&](const Error& error) { return std::vector<Result<JobResult>>(jobs.size(), error); };
    if (jobs.empty()) return {};
    if (interrupted) return all(environment_error("interrupted"));
    const auto scratch = ScratchFolder::make(shared_);
    if (!scratch.ok()) return all(scratch.error());
    const std::string& base = (*scratch)->path();
    std::vector<std::string> folders;
    for (size_t i = 0; i < jobs.size(); ++i) {
        folders.push_back(base + "/" + std::to_string(i));
        std::error_code problem;
        std::filesystem::create_directory(folders.back(), problem);
        const Status written = write_inputs(jobs[i], folders.back());
        if (!written.ok()) return all(written.error());
    }
    const std::string script = base + "/array.sh";
    std::ofstream(script) << script_of(folders, jobs);
    std::vector<std::string> command = {"sbatch",
                                        "--wait",
                                        "--parsable",
                                        "--job-name=kiln",
                                        "--output=/dev/null",
                                        "--array=0-" + std::to_string(jobs.size() - 1)};
    command.insert(command.end(), options_.begin(), options_.end());
    command.push_back(script);
    const std::string log = base + "/sbatch.log";
    const Result<int> code = run_process(command, base, log, deadline, &interrupted);
    std::string number;  // the first thing that sbatch said, with ";CLUSTER" behind it where there are several
    std::getline(std::ifstream(log), number);
    const size_t digits = number.find_first_not_of("0123456789");
    const bool submitted = digits != 0 && !number.empty() && (digits == std::string::npos || number[digits] == ';');
    if (!code.ok()) {
        if (submitted) {  // the array is still there
            std::vector<std::string> scancel{"scancel", number.substr(0, digits)};
            if (digits != std::string::npos) scancel.insert(scancel.begin() + 1, "--clusters=" + number.substr(digits + 1));
            static_cast<void>(run_process(scancel, base, log, std::chrono::seconds(10), nullptr));
        }
        if (interrupted) return all(code.error());
    }
    if (code.ok() && !submitted) return all(environment_error("sbatch took no array" + last_words(log)));
    std::vector<Result<JobResult>> out;
    for (size_t i = 0; i < jobs.size(); ++i) {
        int ended = -1;  // nothing is left by a job that was killed, or whose node was lost
        std::ifstream(folders[i] + "/code") >> ended;
        const std::string name = "job " + std::to_string(i) + " of array " + number;
        if (ended < 0)
            out.push_back(code.ok() ? environment_error(name + " was lost before it ended") : code.error());
        else if (ended != 0)
            out.push_back(environment_error(name + " ended with " + std::to_string(ended) + last_words(folders[i] + "/log")));
        else
            out.push_back(read_outputs(jobs[i], folders[i]));
        if (done) done();
    }
    return out;
}

}  // namespace kiln
