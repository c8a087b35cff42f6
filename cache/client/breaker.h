#pragma once
// Stops asking a server that does not answer: after a few failures in a row nothing is asked for a while, then one caller may
// try again; each time that fails the while is twice as long. A failure that took a deadline's time counts double.

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>

namespace kiln {

class Breaker {
public:
    using Clock = std::chrono::steady_clock;
    struct Rules {
        unsigned failures = 5;
        std::chrono::milliseconds pause{30'000}, longest_pause{300'000};
        std::function<Clock::time_point()> now;  // empty: the clock
    };

    Breaker() : Breaker(Rules()) {}
    explicit Breaker(Rules rules) : rules_(std::move(rules)), pause_(rules_.pause) {}

    bool may_ask() {
        const std::lock_guard lock(mutex_);
        if (!open_) return true;
        if (now() < again_) return false;
        again_ = now() + pause_;  // this caller tries; the others wait for what it finds
        trying_ = true;
        return true;
    }
    void succeeded() {
        const std::lock_guard lock(mutex_);
        failures_ = 0;
        open_ = trying_ = false;
        pause_ = rules_.pause;
    }
    void failed(bool waited) {
        const std::lock_guard lock(mutex_);
        failures_ += waited ? 2 : 1;
        if (open_) {
            if (!trying_) return;  // others that had been asked before
            trying_ = false;
            pause_ = std::min(pause_ * 2, rules_.longest_pause);
            again_ = now() + pause_;
        } else if (failures_ >= rules_.failures) {
            open_ = true;
            ++times_;
            again_ = now() + pause_;
        }
    }
    // How often it began to ask no more.
    unsigned times() const {
        const std::lock_guard lock(mutex_);
        return times_;
    }

private:
    Clock::time_point now() const { return rules_.now ? rules_.now() : Clock::now(); }

    const Rules rules_;
    mutable std::mutex mutex_;
    std::chrono::milliseconds pause_;
    Clock::time_point again_;
    unsigned failures_ = 0, times_ = 0;
    bool open_ = false, trying_ = false;
};

}  // namespace kiln
