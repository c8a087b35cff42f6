#include "compiler/base/jobs.h"

#include <algorithm>
#include <thread>
#include <vector>

namespace kiln {

std::atomic<bool> interrupted{false};

Jobs::Jobs(unsigned threads) : threads_(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency())) {}

bool Jobs::each(size_t count, const std::function<void(size_t)>& body) const {
    std::atomic<size_t> next{0};
    const auto work = [&] {
        while (!interrupted.load(std::memory_order_relaxed)) {
            const size_t i = next.fetch_add(1, std::memory_order_relaxed);
            if (i >= count) return;
            body(i);
        }
    };
    std::vector<std::thread> others;
    const size_t extra = std::min<size_t>(threads_, count);
    for (size_t i = 1; i < extra; ++i) others.emplace_back(work);
    work();
    for (std::thread& t : others) t.join();
    return !interrupted.load(std::memory_order_relaxed);
}

}  // namespace kiln
