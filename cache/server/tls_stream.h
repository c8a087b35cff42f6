#pragma once
// TLS over a socket that OpenSSL reads and writes itself. Boost's own stream holds 68 KiB of buffers for as long as a connection
// is open; OpenSSL's go when they are empty, so that one that waits costs what its keys do. Belongs to http_server.cpp.
//
// One operation at a time, with a deadline as beast::tcp_stream has it: when it passes, the socket is closed and the operation
// ends with beast::error::timeout. Handlers are called from the executor, never from within the call that began the operation.
// The program blocks or ignores SIGPIPE, since OpenSSL writes without MSG_NOSIGNAL.

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/error.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

namespace kiln {

class TlsStream {
    using Clock = std::chrono::steady_clock;
    using Socket = boost::asio::ip::tcp::socket;
    using Code = boost::beast::error_code;

public:
    using executor_type = Socket::executor_type;

    TlsStream(Socket socket, boost::asio::ssl::context& context)
        : socket_(std::move(socket)), timer_(socket_.get_executor()), tls_(::SSL_new(context.native_handle())) {
        Code ignored;
        socket_.native_non_blocking(true, ignored);
        if (!tls_) return;
        ::SSL_set_accept_state(tls_.get());
        ::SSL_set_mode(tls_.get(),
                       SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER | SSL_MODE_RELEASE_BUFFERS);
        if (::SSL_set_fd(tls_.get(), socket_.native_handle()) != 1) tls_.reset();
    }

    executor_type get_executor() { return socket_.get_executor(); }
    Socket& socket() { return socket_; }

    void expires_never() { deadline_ = Clock::time_point::max(); }
    void expires_after(std::chrono::milliseconds after) { expires_at(Clock::now() + after); }
    void expires_at(Clock::time_point when) {
        deadline_ = when;
        if (deadline_ < armed_) arm();
    }

    // handler(error)
    template <class Handler>
    void async_handshake(Handler handler) {
        attempt([](SSL* tls) { return ::SSL_do_handshake(tls); },
                [handler = std::move(handler)](Code failed, size_t) mutable { handler(failed); });
    }
    // handler(error); the peer's farewell is waited for.
    template <class Handler>
    void async_shutdown(Handler handler) {
        attempt(
            [](SSL* tls) {
                const int done = ::SSL_shutdown(tls);
                return done == 0 ? ::SSL_shutdown(tls) : done;
            },
            [handler = std::move(handler)](Code failed, size_t) mutable { handler(failed); });
    }
    // handler(error, bytes)
    template <class Handler>
    void async_read_some(boost::asio::mutable_buffer into, Handler handler) {
        attempt([into](SSL* tls) { return ::SSL_read(tls, into.data(), length(into.size())); }, std::move(handler));
    }
    template <class Buffers, class Handler>
    void async_write_some(const Buffers& buffers, Handler handler) {
        boost::asio::const_buffer from;
        for (auto one = boost::asio::buffer_sequence_begin(buffers);
             from.size() == 0 && one != boost::asio::buffer_sequence_end(buffers); ++one)
            from = *one;
        if (from.size() == 0) return complete(std::move(handler), {}, 0);
        attempt([from](SSL* tls) { return ::SSL_write(tls, from.data(), length(from.size())); }, std::move(handler));
    }

private:
    struct Free {
        void operator()(SSL* tls) const { ::SSL_free(tls); }
    };

    static int length(size_t size) { return static_cast<int>(std::min<size_t>(size, 1 << 20)); }

    // The socket is asked only while it is open: afterwards its number may be another's.
    template <class Step, class Handler>
    void attempt(Step step, Handler handler) {
        if (late_) return complete(std::move(handler), boost::beast::error::timeout, 0);
        if (!socket_.is_open() || !tls_) return complete(std::move(handler), boost::asio::error::operation_aborted, 0);
        ::ERR_clear_error();
        errno = 0;
        const int done = step(tls_.get());
        if (done > 0) return complete(std::move(handler), {}, static_cast<size_t>(done));
        const int code = errno;
        switch (::SSL_get_error(tls_.get(), done)) {
            case SSL_ERROR_WANT_READ:
                return wait(Socket::wait_read, std::move(step), std::move(handler));
            case SSL_ERROR_WANT_WRITE:
                return wait(Socket::wait_write, std::move(step), std::move(handler));
            case SSL_ERROR_ZERO_RETURN:
                return complete(std::move(handler), boost::asio::error::eof, 0);
            case SSL_ERROR_SYSCALL:
                if (code != 0) return complete(std::move(handler), Code(code, boost::system::system_category()), 0);
                break;
            default:
                break;
        }
        complete(std::move(handler), boost::asio::ssl::error::stream_truncated, 0);
    }

    template <class Step, class Handler>
    void wait(Socket::wait_type what, Step step, Handler handler) {
        socket_.async_wait(what, [this, step = std::move(step), handler = std::move(handler)](Code failed) mutable {
            if (late_) return handler(boost::beast::error::timeout, 0);
            if (failed) return handler(failed, 0);
            attempt(std::move(step), std::move(handler));
        });
    }

    template <class Handler>
    void complete(Handler handler, Code failed, size_t bytes) {
        boost::asio::post(socket_.get_executor(),
                          [handler = std::move(handler), failed, bytes]() mutable { handler(failed, bytes); });
    }

    // Deadlines mostly move back, so the timer is left to fire and looks again.
    void arm() {
        armed_ = deadline_;
        timer_.expires_at(armed_);
        timer_.async_wait([this, alive = std::weak_ptr<bool>(alive_)](Code stopped) {
            if (stopped || alive.expired()) return;
            armed_ = Clock::time_point::max();
            if (deadline_ == armed_) return;
            if (deadline_ > Clock::now()) return arm();
            late_ = true;
            Code ignored;
            socket_.close(ignored);
        });
    }

    Socket socket_;
    boost::asio::steady_timer timer_;
    std::unique_ptr<SSL, Free> tls_;
    const std::shared_ptr<bool> alive_ = std::make_shared<bool>();
    Clock::time_point deadline_ = Clock::time_point::max(), armed_ = Clock::time_point::max();
    bool late_ = false;
};

}  // namespace kiln
