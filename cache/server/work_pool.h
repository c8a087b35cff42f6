#pragma once
// Threads for work that may wait: for the disk, or for its turn.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace kiln {

// Runs what it is given, in the order in which it came. What it is given throws nothing.
class WorkPool {
public:
    // Without threads, post() runs the work itself.
    explicit WorkPool(unsigned threads) {
        for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
    }
    // Waits for all that was posted.
    ~WorkPool() {
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
        }
        some_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }
    WorkPool(const WorkPool&) = delete;
    WorkPool& operator=(const WorkPool&) = delete;

    void post(std::function<void()> work) {
        if (threads_.empty()) return work();
        {
            const std::lock_guard lock(mutex_);
            waiting_.push_back(std::move(work));
        }
        some_.notify_one();
    }

private:
    void run() {
        std::unique_lock lock(mutex_);
        while (true) {
            some_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
            if (waiting_.empty()) return;
            const std::function<void()> work = std::move(waiting_.front());
            waiting_.pop_front();
            lock.unlock();
            work();
            lock.lock();
        }
    }

    std::mutex mutex_;
    std::condition_variable some_;
    std::deque<std::function<void()>> waiting_;
    bool ending_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace kiln
