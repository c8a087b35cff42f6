// Each I/O thread has a context of its own and a connection stays on one of them, so that it needs no lock. Reads of small
// blobs are answered there; everything else goes to a pool of threads, since it waits for the disk.
#include "cache/server/http_server.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <algorithm>
#include <mutex>
#include <thread>

#include "cache/server/http_connection.h"

namespace kiln {

namespace {

using boost::asio::ip::tcp;

Result<std::shared_ptr<net::ssl::context>> load_tls(const HttpOptions& options) {
    auto context = std::make_shared<net::ssl::context>(net::ssl::context::tls_server);
    beast::error_code failed;
    context->set_options(net::ssl::context::no_sslv2 | net::ssl::context::no_sslv3 | net::ssl::context::no_tlsv1 |
                             net::ssl::context::no_tlsv1_1 | net::ssl::context::no_compression | SSL_OP_NO_RENEGOTIATION,
                         failed);
    // Sessions are resumed by tickets, which the clients keep.
    ::SSL_CTX_set_session_cache_mode(context->native_handle(), SSL_SESS_CACHE_OFF);
    if (!failed) context->use_certificate_chain_file(options.certificate, failed);
    if (failed) return input_error("certificate " + options.certificate + ": " + failed.message());
    context->use_private_key_file(options.key, net::ssl::context::pem, failed);
    if (failed) return input_error("private key " + options.key + ": " + failed.message());
    return context;
}

class BeastServer final : public HttpServer {
public:
    BeastServer(HttpFace& face, Log& log, const HttpOptions& options)
        : options_(options), pool_(std::max(1u, options.work_threads)), shared_{face, log, options_, pool_} {}

    ~BeastServer() override {
        drain(std::chrono::milliseconds(0));
        for (auto& guard : guards_) guard.reset();
        for (const auto& loop : loops_) loop->context.stop();
        for (std::thread& thread : threads_) thread.join();
        pool_.join();
    }

    Status listen() {
        if (!options_.certificate.empty()) {
            auto tls = load_tls(options_);
            KILN_TRY(tls);
            tls_ = std::move(*tls);
        }
        for (unsigned i = 0; i < std::max(1u, options_.io_threads); ++i) {
            loops_.push_back(std::make_unique<HttpLoop>());
            guards_.push_back(net::make_work_guard(loops_.back()->context));
        }
        beast::error_code failed;
        const auto address = net::ip::make_address(options_.address, failed);
        const auto wrong = [&](const char* doing) {
            return environment_error(std::string("cannot ") + doing + " " + options_.address + " port " +
                                     std::to_string(options_.port) + ": " + failed.message());
        };
        if (failed) return wrong("listen on");
        acceptor_.emplace(loops_[0]->context);
        retry_.emplace(loops_[0]->context);
        const tcp::endpoint endpoint(address, options_.port);
        acceptor_->open(endpoint.protocol(), failed);
        if (!failed) acceptor_->set_option(net::socket_base::reuse_address(true), failed);
        if (!failed) acceptor_->bind(endpoint, failed);
        if (!failed) acceptor_->listen(1024, failed);
        if (failed) return wrong("listen on");
        port_ = acceptor_->local_endpoint(failed).port();
        accept();
        for (const auto& loop : loops_) sweep(*loop);
        for (const auto& loop : loops_) threads_.emplace_back([&context = loop->context] { context.run(); });
        return {};
    }

    uint16_t port() const override { return port_; }

    HttpStats stats() const override {
        const HttpShared& s = shared_;
        return {s.accepted, s.open, s.over_cap, s.out_of_files, s.timeouts, s.malformed, s.handshakes_failed, s.requests};
    }

    Status reload_tls() override {
        if (options_.certificate.empty()) return {};
        auto tls = load_tls(options_);
        KILN_TRY(tls);
        const std::lock_guard lock(tls_mutex_);
        tls_ = std::move(*tls);
        return {};
    }

    bool drain(std::chrono::milliseconds deadline) override {
        if (loops_.empty() || threads_.empty()) return true;
        shared_.draining = true;
        net::post(loops_[0]->context, [this] {
            acceptor_->close(ignored_);
            retry_->cancel();
        });
        const auto each = [&](bool all) {
            for (const auto& loop : loops_)
                net::post(loop->context, [&loop = *loop, all] {
                    const auto now = loop.connections;  // ending one may remove it
                    for (ConnectionBase* connection : now)
                        if (all || connection->idle()) connection->end();
                });
        };
        each(false);
        const auto until = std::chrono::steady_clock::now() + deadline;
        const auto wait = [&](auto time) {
            while (shared_.open != 0 && std::chrono::steady_clock::now() < time)
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            return shared_.open == 0;
        };
        if (wait(until)) return true;
        each(true);
        wait(std::chrono::steady_clock::now() + std::chrono::seconds(5));  // what the disk is doing
        return false;
    }

private:
    // Ends connections that have been idle for too long, at most an eighth of that time or a second late.
    void sweep(HttpLoop& loop) {
        using std::chrono::milliseconds;
        loop.sweep.expires_after(std::clamp(options_.idle_timeout / 8, milliseconds(10), milliseconds(1000)));
        loop.sweep.async_wait([this, &loop](beast::error_code stopped) {
            if (stopped) return;
            const auto now = std::chrono::steady_clock::now();
            std::vector<ConnectionBase*> ended;  // ending one may remove it
            for (ConnectionBase* connection : loop.connections)
                if (connection->idle_too_long(now)) ended.push_back(connection);
            for (ConnectionBase* connection : ended) connection->end();
            sweep(loop);
        });
    }

    void accept() {
        HttpLoop& loop = *loops_[next_++ % loops_.size()];
        acceptor_->async_accept(loop.context, [this, &loop](beast::error_code failed, tcp::socket socket) {
            if (failed == net::error::operation_aborted || shared_.draining) return;
            if (failed) {
                // Out of descriptors or of kernel memory: the connection waits in the kernel's queue meanwhile.
                if (failed.value() == EMFILE || failed.value() == ENFILE || failed.value() == ENOBUFS ||
                    failed.value() == ENOMEM) {
                    if (shared_.out_of_files++ % 100 == 0)
                        shared_.log.event(std::move(LogLine("accept").text("message", failed.message())));
                    retry_->expires_after(std::chrono::milliseconds(50));
                    retry_->async_wait([this](beast::error_code stopped) {
                        if (!stopped) accept();
                    });
                    return;
                }
                return accept();  // this one has gone already
            }
            ++shared_.accepted;
            if (shared_.open >= options_.connections)
                turn_away(socket);
            else
                take(loop, std::move(socket));
            accept();
        });
    }

    void turn_away(tcp::socket& socket) {
        ++shared_.over_cap;
        beast::error_code failed;
        socket.non_blocking(true, failed);
        static constexpr std::string_view busy =
            "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 1\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
        if (options_.certificate.empty()) socket.send(net::buffer(busy), 0, failed);
        socket.shutdown(tcp::socket::shutdown_send, failed);
    }

    void take(HttpLoop& loop, tcp::socket socket) {
        beast::error_code failed;
        socket.set_option(tcp::no_delay(true), failed);
        const auto remote = socket.remote_endpoint(failed);
        std::string peer = failed ? "?" : remote.address().to_string() + ":" + std::to_string(remote.port());
        std::shared_ptr<net::ssl::context> tls;
        {
            const std::lock_guard lock(tls_mutex_);
            tls = tls_;
        }
        // The connection is made on its own loop's thread, whose set of connections it joins.
        net::post(loop.context, [this, &loop, tls, peer = std::move(peer), socket = std::move(socket)]() mutable {
            if (tls != nullptr)
                std::make_shared<Connection<TlsStream>>(shared_, loop, std::move(peer), std::move(socket), *tls)->run();
            else
                std::make_shared<Connection<beast::tcp_stream>>(shared_, loop, std::move(peer), std::move(socket))->run();
        });
    }

    const HttpOptions options_;
    net::thread_pool pool_;
    HttpShared shared_;
    std::mutex tls_mutex_;
    std::shared_ptr<net::ssl::context> tls_;
    std::vector<std::unique_ptr<HttpLoop>> loops_;
    std::vector<net::executor_work_guard<net::io_context::executor_type>> guards_;
    std::vector<std::thread> threads_;
    std::optional<tcp::acceptor> acceptor_;
    std::optional<net::steady_timer> retry_;
    uint16_t port_ = 0;
    size_t next_ = 0;
    beast::error_code ignored_;
};

}  // namespace

Result<std::unique_ptr<HttpServer>> HttpServer::start(HttpFace& face, Log& log, const HttpOptions& options) {
    auto server = std::make_unique<BeastServer>(face, log, options);
    KILN_TRY(server->listen());
    return std::unique_ptr<HttpServer>(std::move(server));
}

}  // namespace kiln
