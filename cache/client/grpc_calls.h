#pragma once
// The channel to a server, calls of one batch, many at a time, and the two streams. Included by the module's sources alone.

#include <bytestream.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include <condition_variable>
#include <functional>
#include <mutex>

#include "cache/client/grpc_remote.h"
#include "compiler/base/bytes.h"

namespace kiln {

// Connects when the first call is made.
std::shared_ptr<grpc::Channel> open_grpc_channel(const RemoteUrl& url, const GrpcRemoteOptions& options);

// When calls end whatever they are doing.
class CallEnd {
public:
    using Clock = std::chrono::steady_clock;
    explicit CallEnd(const std::atomic<bool>* interrupted) : interrupted_(interrupted) {}
    void at(Clock::time_point when) { when_ = when.time_since_epoch().count(); }
    bool now() const {
        return (interrupted_ != nullptr && interrupted_->load()) || Clock::now().time_since_epoch().count() >= when_.load();
    }

private:
    const std::atomic<bool>* const interrupted_;
    std::atomic<Clock::rep> when_{Clock::time_point::max().time_since_epoch().count()};
};

// What one call needs until its end.
struct OneCall {
    std::unique_ptr<grpc::ClientContext> context;
    grpc::Status status{grpc::StatusCode::UNAVAILABLE, "given up"};
    bool running = false;
};

using CallDone = std::function<void(grpc::Status)>;

// Starts call after call, `wide` at a time; start(i, done) must call `done` once when it has ended, on any thread. Returns
// when all have. After `patience` calls in a row that got no answer, or at the end, the rest is not started and what runs is
// cancelled.
template <class Start>
void run_calls(std::vector<OneCall*> calls, size_t wide, unsigned patience, const CallEnd& end, const Start& start) {
    struct Shared {
        std::mutex mutex;
        std::condition_variable wake;
        size_t running = 0;
        unsigned unanswered = 0;
    };
    // Shared, for the last call still holds the mutex when this thread sees that it has ended.
    const auto shared = std::make_shared<Shared>();
    size_t next = 0;
    std::unique_lock lock(shared->mutex);
    while (next < calls.size() || shared->running != 0) {
        if (end.now() || shared->unanswered >= patience) {
            next = calls.size();
            for (OneCall* call : calls)
                if (call->running) call->context->TryCancel();
        }
        while (next < calls.size() && shared->running < wide && shared->unanswered < patience) {
            OneCall* call = calls[next];
            call->running = true;
            ++shared->running;
            const size_t index = next++;
            lock.unlock();
            start(index, [shared, call](grpc::Status status) {
                const std::lock_guard held(shared->mutex);
                const auto code = status.error_code();
                const bool silent = code == grpc::StatusCode::UNAVAILABLE || code == grpc::StatusCode::DEADLINE_EXCEEDED ||
                                    code == grpc::StatusCode::CANCELLED;
                shared->unanswered = silent ? shared->unanswered + 1 : 0;
                call->status = std::move(status);
                call->running = false;
                --shared->running;
                shared->wake.notify_one();
            });
            lock.lock();
        }
        if (shared->running != 0) shared->wake.wait_for(lock, std::chrono::milliseconds(50));
    }
}

// Reads a blob of a known size; one byte more ends the call.
class Download final : public grpc::ClientReadReactor<google::bytestream::ReadResponse> {
public:
    Download(google::bytestream::ByteStream::Stub& stub, grpc::ClientContext& context, const std::string& name, uint64_t size,
             CallDone done)
        : context_(context), size_(size), done_(std::move(done)) {
        request_.set_resource_name(name);
        stub.async()->Read(&context, &request_, this);
        StartRead(&piece_);
        StartCall();
    }
    void OnReadDone(bool ok) override {
        if (!ok) return;
        // Room for what came and not for what was promised: the size is somebody's word.
        if (piece_.data().size() > size_ - bytes.size()) {
            too_long = true;
            context_.TryCancel();
            return;
        }
        bytes.insert(bytes.end(), piece_.data().begin(), piece_.data().end());
        StartRead(&piece_);
    }
    void OnDone(const grpc::Status& status) override {
        const CallDone done = std::move(done_);
        done(status);
    }

    Bytes bytes;
    bool too_long = false;

private:
    grpc::ClientContext& context_;
    google::bytestream::ReadRequest request_;
    google::bytestream::ReadResponse piece_;
    const uint64_t size_;
    CallDone done_;
};

class Upload final : public grpc::ClientWriteReactor<google::bytestream::WriteRequest> {
public:
    Upload(google::bytestream::ByteStream::Stub& stub, grpc::ClientContext& context, const std::string& name, ByteView from,
           CallDone done)
        : bytes_(from), done_(std::move(done)) {
        piece_.set_resource_name(name);
        stub.async()->Write(&context, &response, this);
        next();
        StartCall();
    }
    void OnWriteDone(bool ok) override {
        if (!ok || piece_.finish_write()) return;  // a server that has the blob already ends the call early
        piece_.clear_resource_name();
        next();
    }
    void OnDone(const grpc::Status& status) override {
        const CallDone done = std::move(done_);
        done(status);
    }

    google::bytestream::WriteResponse response;

private:
    void next() {
        const size_t size = std::min<size_t>(bytes_.size() - sent_, 1024 * 1024);
        piece_.set_write_offset(static_cast<int64_t>(sent_));
        piece_.set_data(bytes_.data() + sent_, size);
        sent_ += size;
        piece_.set_finish_write(sent_ == bytes_.size());
        if (piece_.finish_write())
            StartWriteLast(&piece_, grpc::WriteOptions());
        else
            StartWrite(&piece_);
    }

    const ByteView bytes_;
    size_t sent_ = 0;
    google::bytestream::WriteRequest piece_;
    CallDone done_;
};

}  // namespace kiln
