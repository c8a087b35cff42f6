#include "cache/execute/engine.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

namespace kiln {

std::vector<Result<JobResult>> Engine::run_all(std::span<const Job> jobs, std::chrono::milliseconds deadline,
                                               const std::function<void()>& done) {
    std::vector<std::optional<Result<JobResult>>> results(jobs.size());
    const auto end = std::chrono::steady_clock::now() + deadline;
    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t i = next++; i < jobs.size(); i = next++) {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
            results[i].emplace(left.count() > 0 ? run(jobs[i], left) : environment_error("no time was left for it"));
            if (done) done();
        }
    };
    std::vector<std::thread> threads;
    for (size_t t = 0; t < std::min(std::max<size_t>(width(), 1), jobs.size()); ++t) threads.emplace_back(work);
    for (std::thread& t : threads) t.join();
    std::vector<Result<JobResult>> out;
    for (auto& r : results) out.push_back(std::move(*r));
    return out;
}

std::string one_line(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 300)) out += c >= ' ' && c <= '~' ? c : ' ';
    while (!out.empty() && out.back() == ' ') out.pop_back();
    return out;
}

}  // namespace kiln
