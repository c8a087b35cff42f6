#pragma once
// A parallel loop and the one flag that stops it. Results go into slots that the caller owns by index, so that the order
// of threads never shows in an output.

#include <atomic>
#include <cstddef>
#include <functional>

namespace kiln {

// Set by the command line's signal handler; long loops look at it between steps.
extern std::atomic<bool> interrupted;

class Jobs {
public:
    explicit Jobs(unsigned threads);  // 0: one a hardware thread
    unsigned threads() const { return threads_; }
    // Calls body(i) once for every i in [0, count), from up to threads() threads, and returns when all have ended. After
    // `interrupted` is set no further index is started; returns false then.
    bool each(size_t count, const std::function<void(size_t)>& body) const;

private:
    unsigned threads_;
};

}  // namespace kiln
