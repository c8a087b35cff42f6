#pragma once
// Ends calls that take too long. An alarm of gRPC's costs a call two changes of thread; here a thread looks once a second, as the
// HTTP front does, so that a call lives up to a second longer than it may.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace grpc {
class ServerContext;
}

namespace kiln {

class CallDeadlines {
    using Clock = std::chrono::steady_clock;

public:
    CallDeadlines() = default;
    ~CallDeadlines();  // after the last Deadline
    CallDeadlines(const CallDeadlines&) = delete;
    CallDeadlines& operator=(const CallDeadlines&) = delete;

    // Of one call, whose context outlives it.
    class Deadline {
    public:
        Deadline(CallDeadlines& all, grpc::ServerContext& context) : all_(all), context_(context) {}
        ~Deadline();
        Deadline(const Deadline&) = delete;
        Deadline& operator=(const Deadline&) = delete;
        void set(std::chrono::milliseconds after);  // from now on; again moves it
        bool is_set() const { return linked_; }

    private:
        friend class CallDeadlines;
        CallDeadlines& all_;
        grpc::ServerContext& context_;
        bool linked_ = false;
        Clock::time_point when_{};
        Deadline *before_ = nullptr, *after_ = nullptr;
    };

private:
    void watch();

    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    Deadline* first_ = nullptr;
    std::thread thread_{[this] { watch(); }};  // last: it uses the others
};

}  // namespace kiln
