#include "cache/execute/local_engine.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "cache/protocol/action_result.h"
#include "compiler/base/jobs.h"

extern char** environ;

namespace kiln {
namespace {

Error failed(const std::string& what) { return environment_error(what + ": " + std::strerror(errno)); }

}  // namespace

Result<std::unique_ptr<ScratchFolder>> ScratchFolder::make(const std::string& below) {
    std::string name = below + "/kiln-job-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) return failed(name);
    return std::unique_ptr<ScratchFolder>(new ScratchFolder(name));
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

Status write_inputs(const Job& job, const std::string& folder) {
    for (const JobFile& file : job.inputs) {
        if (!stays_below(file.path)) return input_error("a job's file lies outside its folder: " + file.path);
        const std::filesystem::path path = std::filesystem::path(folder) / file.path;
        std::error_code problem;
        std::filesystem::create_directories(path.parent_path(), problem);
        const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, file.executable ? 0700 : 0600);
        if (fd < 0) return failed(path.string());
        size_t done = 0;
        while (done < file.bytes->size()) {
            const ssize_t n = ::write(fd, file.bytes->data() + done, file.bytes->size() - done);
            if (n < 0 && errno == EINTR) continue;
            if (n < 0) break;
            done += static_cast<size_t>(n);
        }
        const Error error = failed(path.string());
        ::close(fd);
        if (done != file.bytes->size()) return error;
    }
    return {};
}

Result<JobResult> read_outputs(const Job& job, const std::string& folder) {
    JobResult out;
    for (const std::string& name : job.outputs) {
        if (!stays_below(name)) return input_error("a job's output lies outside its folder: " + name);
        const std::string path = folder + "/" + name;
        struct stat info {};
        if (::lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return environment_error("the job left no file " + name);
        if (static_cast<uint64_t>(info.st_size) > largest_output) return environment_error("the job's " + name + " is too large");
        std::ifstream in(path, std::ios::binary);
        Bytes bytes(static_cast<size_t>(info.st_size));
        in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        if (in.gcount() != static_cast<std::streamsize>(bytes.size()))
            return environment_error("the job's " + name + " cannot be read");
        out.outputs.push_back(std::move(bytes));
    }
    return out;
}

Result<int> run_process(const std::vector<std::string>& arguments, const std::string& folder, const std::string& log,
                        std::chrono::milliseconds deadline, const std::atomic<bool>* stop) {
    std::vector<char*> argv;
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
    // A process group of its own: what it starts is ended with it.
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
    ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    pid_t child = 0;
    const int problem = ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
    if (problem != 0) return environment_error("cannot start " + arguments[0] + ": " + std::strerror(problem));
    const auto end = std::chrono::steady_clock::now() + deadline;
    auto pause = std::chrono::milliseconds(1);
    while (true) {
        int status = 0;
        const pid_t got = ::waitpid(child, &status, WNOHANG);
        if (got < 0 && errno != EINTR) return failed(arguments[0]);
        if (got == child && WIFEXITED(status)) return WEXITSTATUS(status);
        if (got == child) return environment_error(arguments[0] + " was ended by signal " + std::to_string(WTERMSIG(status)));
        const bool stopped = stop != nullptr && stop->load();
        if (stopped || std::chrono::steady_clock::now() > end) {
            ::kill(-child, SIGKILL);
            ::waitpid(child, &status, 0);
            return environment_error(stopped ? "interrupted" : arguments[0] + " did not end in time");
        }
        std::this_thread::sleep_for(pause);
        pause = std::min(pause * 2, std::chrono::milliseconds(20));
    }
}

std::string last_words(const std::string& log) {
    constexpr std::streamoff most = 300;
    std::ifstream in(log, std::ios::binary | std::ios::ate);
    if (!in) return {};
    in.seekg(std::max(std::streamoff{0}, static_cast<std::streamoff>(in.tellg()) - most));
    const std::string words = one_line(std::string(std::istreambuf_iterator<char>(in), {}));
    return words.empty() ? words : ": " + words;
}

Result<JobResult> LocalEngine::run(const Job& job, std::chrono::milliseconds deadline) {
    if (interrupted) return environment_error("interrupted");
    const auto folder = ScratchFolder::make(std::filesystem::temp_directory_path().string());
    KILN_TRY(folder);
    const std::string& path = (*folder)->path();
    KILN_TRY(write_inputs(job, path));
    const Result<int> code = run_process(job.arguments, path, path + "/log", deadline, &interrupted);
    KILN_TRY(code);
    if (*code != 0)
        return environment_error(job.arguments[0] + " ended with " + std::to_string(*code) + last_words(path + "/log"));
    return read_outputs(job, path);
}

}  // namespace kiln
