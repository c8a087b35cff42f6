#pragma once
// The sockets of the HTTP front: accepting, TLS, limits, deadlines, draining. What a request means is HttpFace's.
//
// Promises: a client that is slow at its head, its body or at reading costs one connection for no longer than its deadline,
// which for a body or a response grows with its bytes and not with its patience;
// memory for bodies grows with what has arrived, not with what was announced; a request whose end is in doubt (two lengths, a
// length and a transfer coding, an unknown coding) is refused and its connection closed; more connections than the cap are
// answered 503; running out of descriptors stops accepting for a moment and nothing else.

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "cache/server/http_face.h"
#include "cache/server/log.h"

namespace kiln {

struct HttpOptions {
    std::string address = "127.0.0.1";  // a numeric one
    uint16_t port = 0;                  // 0: the kernel chooses
    std::string certificate, key;       // files in PEM; both empty: no TLS
    // 0 work threads: what waits for the disk does so on the I/O thread, which saves a request two changes of thread and lets
    // everybody wait while entries are evicted.
    unsigned io_threads = 1, work_threads = 4;
    uint32_t header_bytes = 16 * 1024;
    size_t connections = 4096;
    // A body, or a response, may take in all: `patience`, and its bytes at `slowest` a second.
    std::chrono::milliseconds patience{60'000};
    uint64_t slowest = 64 * 1024;
    // head: of a request, once it has begun, and of a TLS handshake. body and write: for each 64 KiB. idle: between requests.
    std::chrono::milliseconds head_timeout{10'000}, body_timeout{20'000}, write_timeout{20'000}, idle_timeout{60'000};
};

struct HttpStats {
    uint64_t accepted = 0, open = 0;
    uint64_t over_cap = 0;      // answered 503 since there were too many
    uint64_t out_of_files = 0;  // times that accepting had to wait for descriptors
    uint64_t timeouts = 0;      // connections ended by a deadline while a request was under way
    uint64_t malformed = 0;     // requests that were not HTTP as it is taken here
    uint64_t handshakes_failed = 0;
    uint64_t requests = 0;
};

class HttpServer {
public:
    // Listens when it returns. `face` and `log` outlive the server.
    static Result<std::unique_ptr<HttpServer>> start(HttpFace& face, Log& log, const HttpOptions& options);
    virtual ~HttpServer() = default;
    virtual uint16_t port() const = 0;
    virtual HttpStats stats() const = 0;
    // Stops accepting, ends idle connections, lets requests finish until the deadline, ends the others. False: some were cut.
    virtual bool drain(std::chrono::milliseconds deadline) = 0;
    // Reads certificate and key again, for connections from now on. Keeps the old ones on an Error.
    virtual Status reload_tls() = 0;
};

}  // namespace kiln
