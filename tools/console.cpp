#include "tools/console.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace kiln {

namespace {

bool progress_shown = false;
std::mutex progress_mutex;

struct Rate {
    std::string what;
    std::chrono::steady_clock::time_point start, shown;

    // ", 12 s left" once that can be told.
    std::string left(std::chrono::steady_clock::time_point now, size_t done, size_t total) const {
        const double seconds = std::chrono::duration<double>(now - start).count();
        if (done == 0 || done >= total || seconds <= 1.0) return {};
        const double rest = seconds * static_cast<double>(total - done) / static_cast<double>(done);
        return ", " + std::to_string(std::llround(rest)) + " s left";
    }
};

Progress terminal_progress() {
    return [rate = Rate()](const char* what, size_t done, size_t total) mutable {
        const std::lock_guard lock(progress_mutex);
        const auto now = std::chrono::steady_clock::now();
        if (rate.what != what) rate = {what, now, {}};
        if (done < total && now - rate.shown < std::chrono::milliseconds(100)) return;
        rate.shown = now;
        std::fprintf(stderr, "\r\x1b[K%s %zu/%zu%s", what, done, total, rate.left(now, done, total).c_str());
        std::fflush(stderr);
        progress_shown = true;
    };
}

// A CI log: whole lines, few of them, since a job that says nothing for minutes is taken for dead.
Progress log_progress(std::chrono::seconds apart) {
    const auto begun = std::chrono::steady_clock::now();
    return [apart, rate = Rate{{}, begun, begun}](const char* what, size_t done, size_t total) mutable {
        const std::lock_guard lock(progress_mutex);
        const auto now = std::chrono::steady_clock::now();
        if (rate.what != what) rate = {what, now, rate.shown};
        if (now - rate.shown < apart) return;
        rate.shown = now;
        std::fprintf(stderr, "kiln: %s %zu/%zu%s\n", what, done, total, rate.left(now, done, total).c_str());
    };
}

}  // namespace

bool colour_wanted() {
    const char* const term = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr &&
           (term == nullptr || std::strcmp(term, "dumb") != 0);
}

void print_diags(const Diags& diags, size_t most) {
    clear_progress();
    const bool colour = colour_wanted();
    size_t shown[3] = {}, hidden[3] = {};
    for (const Diag& diag : diags.list()) {
        const size_t kind = static_cast<size_t>(diag.severity);
        if (shown[kind] == most) {
            ++hidden[kind];
            continue;
        }
        ++shown[kind];
        std::fputs(render(diag, colour).c_str(), stderr);
    }
    if (hidden[2] != 0) std::fprintf(stderr, "kiln: and %zu more errors\n", hidden[2]);
    if (hidden[1] != 0) std::fprintf(stderr, "kiln: and %zu more warnings\n", hidden[1]);
}

int print_error(const Error& error) {
    clear_progress();
    Diag diag;
    diag.message = error.message;
    std::fputs(render(diag, colour_wanted()).c_str(), stderr);
    return static_cast<int>(error.fault);
}

void print_note(const std::string& text) {
    clear_progress();
    std::fprintf(stderr, "kiln: %s\n", text.c_str());
}

Status print_out(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        return environment_error(std::string("cannot write to standard output: ") + std::strerror(errno));
    return {};
}

int finish(const std::string& text, int code) {
    const Status status = print_out(text);
    if (!status.ok() && errno == EPIPE) {  // `| head`: the reader has what it wanted; end as every filter does
        std::signal(SIGPIPE, SIG_DFL);
        std::raise(SIGPIPE);
    }
    return status.ok() ? code : print_error(status.error());
}

Progress console_progress() {
    const char* const term = std::getenv("TERM");
    if (::isatty(STDERR_FILENO) == 1 && (term == nullptr || std::strcmp(term, "dumb") != 0)) return terminal_progress();
    const char* const asked = std::getenv("KILN_PROGRESS");
    if (asked != nullptr && std::strcmp(asked, "off") == 0) return {};
    long apart = 30;
    if (asked != nullptr) {
        const size_t length = std::strlen(asked);
        if (length > 0 && length < 6 && std::strspn(asked, "0123456789") == length)
            apart = std::strtol(asked, nullptr, 10);
        else
            print_note(std::string("KILN_PROGRESS takes seconds from 0 to 99999 or 'off', not '") + asked + "'; taken for 30");
    }
    return log_progress(std::chrono::seconds(apart));
}

void clear_progress() {
    const std::lock_guard lock(progress_mutex);
    if (!progress_shown) return;
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
    progress_shown = false;
}

}  // namespace kiln
