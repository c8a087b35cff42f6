#include "cache/server/grpc_deadlines.h"

#include <utility>

#include "cache/server/grpc_call.h"

namespace kiln {

CallDeadlines::~CallDeadlines() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

CallDeadlines::Deadline::~Deadline() {
    if (!linked_) return;
    const std::lock_guard lock(all_.mutex_);
    (before_ ? before_->after_ : all_.first_) = after_;
    if (after_) after_->before_ = before_;
}

void CallDeadlines::Deadline::set(std::chrono::milliseconds after) {
    const Clock::time_point when = Clock::now() + after;
    const std::lock_guard lock(all_.mutex_);
    when_ = when;
    if (std::exchange(linked_, true)) return;
    after_ = std::exchange(all_.first_, this);
    if (after_) after_->before_ = this;
}

// Nothing that TryCancel() sets off comes back here on this thread: a call hears of it by an event of its queue.
void CallDeadlines::watch() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return stop_; })) {
        const Clock::time_point now = Clock::now();
        for (Deadline* one = first_; one != nullptr; one = one->after_)
            if (one->when_ <= now) {
                one->context_.TryCancel();
                one->when_ = Clock::time_point::max();
            }
    }
}

}  // namespace kiln
