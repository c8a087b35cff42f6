#pragma once
// HTTP requests by libcurl, many at a time over connections that are kept: one thread drives them, any number of threads
// hand it batches and wait. libcurl is loaded when the first transfer is opened, so that a build without a server does not
// pay for it.
//
// A response is bounded whatever the server does: its body by the request's limit (counted as it arrives), its headers by 64
// KiB, its time by a deadline and a least speed. Redirects are not followed, nothing is decompressed, only http and https
// are spoken, and the token is sent to no other host.

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

struct HttpOptions {
    std::chrono::milliseconds timeout{5000};  // without an answer, or without enough of its body
    std::string token;                        // empty: none; else sent as a bearer token
    std::string ca_file;                      // empty: the system's
    size_t connections = 16;
    bool no_proxy = false;  // whatever the environment says
};

struct HttpRequest {
    enum class Method { get, head, put };
    Method method = Method::get;
    std::string url;
    ByteView body;       // of a put; must live until run() returns
    uint64_t limit = 0;  // bytes of a get's body
};

struct HttpReply {
    int status = 0;  // 0: none came, and `problem` says why
    Bytes body;      // of a get that was answered 200
    std::string problem;
    bool timed_out = false;
    bool kept_first = false;  // of a put: kiln-cached says that it keeps other bytes
};

class HttpTransfer {
public:
    // An Error where libcurl cannot be loaded or the token or CA file cannot be used.
    static Result<std::unique_ptr<HttpTransfer>> open(const HttpOptions& options);
    ~HttpTransfer();

    // In the order of the requests. After `patience` of them in a row got no answer, the rest is not tried.
    std::vector<HttpReply> run(std::span<const HttpRequest> requests, unsigned patience);
    void end_at(std::chrono::steady_clock::time_point when);

private:
    struct Engine;
    explicit HttpTransfer(std::unique_ptr<Engine> engine);
    std::unique_ptr<Engine> engine_;
};

}  // namespace kiln
