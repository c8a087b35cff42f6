#pragma once
// What the connections of the HTTP front share, and what the server knows of each. Belongs to http_server.cpp.

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>

#include <atomic>
#include <chrono>
#include <unordered_set>

#include "cache/server/http_server.h"

namespace kiln {

namespace net = boost::asio;

class ConnectionBase;

// A thread, its sockets, and the connections on it, which only that thread touches.
struct HttpLoop {
    std::unordered_set<ConnectionBase*> connections;
    net::io_context context{1};  // its handlers own the connections: it goes first
    net::steady_timer sweep{context};
};

struct HttpShared {
    HttpFace& face;
    Log& log;
    const HttpOptions& options;
    net::thread_pool& pool;
    std::atomic<bool> draining{false};
    std::atomic<uint64_t> accepted{0}, open{0}, over_cap{0}, out_of_files{0}, timeouts{0}, malformed{0}, handshakes_failed{0},
        requests{0};
};

class ConnectionBase {
public:
    ConnectionBase(HttpShared& shared, HttpLoop& loop) : shared_(shared), loop_(loop) {
        loop_.connections.insert(this);
        ++shared_.open;
    }
    virtual ~ConnectionBase() {
        loop_.connections.erase(this);
        --shared_.open;
    }
    ConnectionBase(const ConnectionBase&) = delete;
    ConnectionBase& operator=(const ConnectionBase&) = delete;
    virtual void end() = 0;  // at once; pending operations fail
    bool idle() const { return idle_; }
    bool idle_too_long(std::chrono::steady_clock::time_point now) const { return idle_ && now >= idle_until_; }

protected:
    HttpShared& shared_;
    HttpLoop& loop_;
    bool idle_ = true;  // between requests
    // A timer for each wait between requests would cost a small request two system calls: the loop looks now and then instead.
    std::chrono::steady_clock::time_point idle_until_ = std::chrono::steady_clock::time_point::max();
};

}  // namespace kiln
