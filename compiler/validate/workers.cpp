// One thread and poll(): a worker has one job at a time, and sending it the next takes microseconds, so there is nothing to
// overlap. posix_spawn and not fork, since the caller has threads.

#include "compiler/validate/workers.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <thread>

#include "compiler/base/jobs.h"
#include "compiler/base/wire.h"
#include "compiler/validate/check_wire.h"

extern char** environ;

namespace kiln {

namespace {

// Address sanitizer reserves terabytes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KILN_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KILN_SANITIZED
#endif
#endif

constexpr rlim_t worker_memory = rlim_t{8} << 30;
constexpr uint64_t frame_limit = uint64_t{256} << 20;
constexpr uint8_t kind_error = 0, kind_info = 1, kind_verdict = 2;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool send_all(int fd, ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t n = send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(n));
    }
    return true;
}

bool send_frame(int fd, ByteView payload) {
    WireWriter head;
    head.u64(payload.size());
    return send_all(fd, head.view()) && send_all(fd, payload);
}

bool receive_all(int fd, uint8_t* to, size_t size) {
    while (size != 0) {
        const ssize_t n = recv(fd, to, size, 0);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        to += n;
        size -= static_cast<size_t>(n);
    }
    return true;
}

std::optional<Bytes> receive_frame(int fd) {
    uint8_t head[8];
    if (!receive_all(fd, head, sizeof head)) return std::nullopt;
    const uint64_t size = WireReader(head).u64();
    if (size > frame_limit) return std::nullopt;
    Bytes out(static_cast<size_t>(size));
    if (!receive_all(fd, out.data(), out.size())) return std::nullopt;
    return out;
}

constexpr size_t no_job = ~size_t{0};

struct Worker {
    pid_t pid = -1;
    int socket = -1;
    int printed = -1;  // what it wrote to standard output and error
    size_t job = no_job;
    double deadline = 0;
    uint32_t finished = 0;
    bool ready = false;  // it has said which device it has
};

std::string tail_of(int fd) {
    constexpr off_t most = 400;
    const off_t end = lseek(fd, 0, SEEK_END);
    if (end <= 0) return {};
    std::string text(static_cast<size_t>(std::min(end, most)), '\0');
    const ssize_t n = pread(fd, text.data(), text.size(), std::max<off_t>(0, end - most));
    text.resize(n < 0 ? 0 : static_cast<size_t>(n));
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    return text;
}

// Kills where it still runs; says how it ended, and the end of what it printed.
std::string finish(Worker& w, bool kill_it) {
    std::string out;
    if (w.pid > 0) {
        if (kill_it) kill(w.pid, SIGKILL);
        int status = 0;
        while (waitpid(w.pid, &status, 0) < 0 && errno == EINTR) {
        }
        if (WIFSIGNALED(status))
            out = "signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
        else
            out = "exit code " + std::to_string(WEXITSTATUS(status));
        const std::string said = tail_of(w.printed);
        if (!said.empty()) out += ", last words: " + said;
    }
    if (w.socket >= 0) close(w.socket);
    if (w.printed >= 0) close(w.printed);
    w = {};
    return out;
}

Status spawn(const WorkerOptions& options, Worker& out) {
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
        return environment_error(std::string("cannot make a socket for a worker: ") + std::strerror(errno));
    out.socket = pair[0];
    out.printed = memfd_create("kiln-worker", MFD_CLOEXEC);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pair[1], 0);
    if (out.printed >= 0) {
        posix_spawn_file_actions_adddup2(&actions, out.printed, 1);
        posix_spawn_file_actions_adddup2(&actions, out.printed, 2);
    }
    std::vector<char*> arguments;
    for (const std::string& a : options.command) arguments.push_back(const_cast<char*>(a.c_str()));
    arguments.push_back(nullptr);
    const int failed = posix_spawn(&out.pid, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pair[1]);
    if (failed != 0) {
        out.pid = -1;
        finish(out, false);
        return environment_error("cannot start the worker '" + options.command.front() + "': " + std::strerror(failed));
    }
    out.deadline = now() + options.timeout_seconds;
    return {};
}

class ProcessPool final : public WorkerPool {
public:
    explicit ProcessPool(const WorkerOptions& options) : options_(options) {}
    ~ProcessPool() override { stop(); }
    const DeviceInfo& info() const override { return info_; }
    Status open();
    Status run(size_t count, const std::function<CheckJob(size_t)>& job, const CheckDone& done) override;

private:
    void stop() {
        for (Worker& w : workers_) finish(w, true);
        workers_.clear();
    }
    Status greet(Worker& w, ByteView frame);
    bool give(Worker& w, size_t index, const std::function<CheckJob(size_t)>& job);

    WorkerOptions options_;
    DeviceInfo info_;
    std::vector<Worker> workers_;
};

// The worker's first frame: its device, or why it has none.
Status ProcessPool::greet(Worker& w, ByteView frame) {
    WireReader in(frame);
    const uint8_t kind = in.u8();
    if (kind == kind_error) return environment_error(in.text());
    std::optional<DeviceInfo> info = kind == kind_info ? decode_info(in.bytes()) : std::nullopt;
    if (!info) return environment_error("a worker did not say which device it has");
    if (info_.name.empty()) info_ = *info;
    w.ready = true;
    return {};
}

Status ProcessPool::open() {
    workers_.resize(options_.count != 0 ? options_.count : std::max(1u, std::thread::hardware_concurrency()));
    Worker& first = workers_.front();
    KILN_TRY(spawn(options_, first));
    while (!first.ready) {
        pollfd waiting{first.socket, POLLIN, 0};
        const int n = poll(&waiting, 1, 100);
        if (interrupted) return environment_error("interrupted");
        if (n > 0) {
            const std::optional<Bytes> frame = receive_frame(first.socket);
            if (!frame) return environment_error("the worker that opens the Vulkan driver died: " + finish(first, true));
            KILN_TRY(greet(first, *frame));
        } else if (now() > first.deadline) {
            finish(first, true);
            return environment_error("the Vulkan driver did not open in time");
        }
    }
    return {};
}

bool ProcessPool::give(Worker& w, size_t index, const std::function<CheckJob(size_t)>& job) {
    w.job = index;
    w.deadline = now() + options_.timeout_seconds;
    return send_frame(w.socket, encode(job(index)));
}

Status ProcessPool::run(size_t count, const std::function<CheckJob(size_t)>& job, const CheckDone& done) {
    std::deque<size_t> again;  // crashed in a worker that had already run others
    std::vector<bool> retried(count, false);
    size_t next = 0, left = count;
    uint32_t deaths_without_job = 0;
    const auto lost = [&](Worker& w, bool timed_out) {
        const size_t index = w.job;
        const bool fresh = w.finished == 0;
        const std::string how = finish(w, timed_out);
        if (index == no_job) {
            ++deaths_without_job;
            return;
        }
        if (!timed_out && !fresh && !retried[index]) {
            retried[index] = true;
            again.push_back(index);
            return;
        }
        Verdict v;
        v.outcome = Outcome::failed;
        v.why = timed_out ? "the driver hung: no result in " + std::to_string(static_cast<int>(options_.timeout_seconds)) + " s"
                          : "the driver crashed: " + how;
        done(index, v, false);
        --left;
    };
    while (left != 0) {
        if (interrupted) {
            stop();
            workers_.resize(1);
            return environment_error("interrupted");
        }
        if (deaths_without_job > 8) return environment_error("workers die before they have opened the driver");
        std::vector<pollfd> waiting;
        std::vector<Worker*> who;
        for (Worker& w : workers_) {
            if (w.ready && w.job == no_job && w.finished >= options_.recycle_after) finish(w, true);
            const bool wanted = next < count || !again.empty();
            if (w.pid < 0 && wanted) KILN_TRY(spawn(options_, w));
            if (w.ready && w.job == no_job && wanted) {
                // A second try begins in a fresh process, where only this pipeline can be to blame.
                if (!again.empty() && w.finished != 0) {
                    finish(w, true);
                    KILN_TRY(spawn(options_, w));
                } else {
                    const size_t index = again.empty() ? next++ : again.front();
                    if (!again.empty()) again.pop_front();
                    if (!give(w, index, job)) lost(w, false);
                }
            }
            if (w.pid < 0 || (w.ready && w.job == no_job)) continue;
            waiting.push_back({w.socket, POLLIN, 0});
            who.push_back(&w);
        }
        if (poll(waiting.data(), waiting.size(), 100) < 0 && errno != EINTR)
            return environment_error(std::string("cannot wait for workers: ") + std::strerror(errno));
        for (size_t i = 0; i < waiting.size(); ++i) {
            Worker& w = *who[i];
            if ((waiting[i].revents & (POLLIN | POLLHUP | POLLERR)) == 0) {
                if (now() > w.deadline) lost(w, true);
                continue;
            }
            const std::optional<Bytes> frame = receive_frame(w.socket);
            if (!frame) {
                lost(w, false);
                continue;
            }
            if (!w.ready) {
                KILN_TRY(greet(w, *frame));
                continue;
            }
            WireReader in(*frame);
            const uint8_t kind = in.u8();
            std::optional<Verdict> verdict = kind == kind_verdict ? decode_verdict(in.bytes()) : std::nullopt;
            if (w.job == no_job || (!verdict && kind != kind_error)) return environment_error("a worker answered nonsense");
            if (!verdict) {  // its device is lost: the pipeline's doing, and the end of that worker
                verdict.emplace();
                verdict->outcome = Outcome::failed;
                verdict->why = in.text();
            }
            const size_t index = w.job;
            w.job = no_job;
            ++w.finished;
            --left;
            done(index, *verdict, kind == kind_verdict);
            if (kind == kind_error) finish(w, true);
        }
    }
    return {};
}

Bytes framed(uint8_t kind, ByteView payload) {
    WireWriter out;
    out.u8(kind);
    out.bytes(payload);
    return out.take();
}

}  // namespace

Result<std::unique_ptr<WorkerPool>> WorkerPool::start(const WorkerOptions& options) {
    auto pool = std::make_unique<ProcessPool>(options);
    KILN_TRY(pool->open());
    return std::unique_ptr<WorkerPool>(std::move(pool));
}

int run_worker(const std::function<Result<std::unique_ptr<Device>>()>& open) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // a hung worker must not outlive its parent
    signal(SIGINT, SIG_IGN);           // the terminal's Ctrl-C reaches us too; the parent decides
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
#if !defined(KILN_SANITIZED)
    const rlimit memory{worker_memory, worker_memory};  // what runs away fails in its own process, not in its neighbours
    setrlimit(RLIMIT_AS, &memory);
#endif
    const int socket = fcntl(0, F_DUPFD_CLOEXEC, 3);
    if (socket < 0) return static_cast<int>(Fault::environment);
    Result<std::unique_ptr<Device>> device = open();
    if (!device.ok()) {
        send_frame(socket, framed(kind_error, as_bytes(device.error().message)));
        return static_cast<int>(Fault::environment);
    }
    if (!send_frame(socket, framed(kind_info, encode((*device)->info())))) return static_cast<int>(Fault::environment);
    while (const std::optional<Bytes> frame = receive_frame(socket)) {
        const std::optional<CheckJob> job = decode_job(*frame);
        if (!job) return static_cast<int>(Fault::environment);
        const Result<Verdict> verdict = check_pipeline(**device, *job);
        const Bytes answer =
            verdict.ok() ? framed(kind_verdict, encode(*verdict)) : framed(kind_error, as_bytes(verdict.error().message));
        if (!send_frame(socket, answer)) break;
    }
    return 0;
}

}  // namespace kiln
