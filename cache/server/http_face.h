#pragma once
// The HTTP protocol of the server without its sockets: what a request's head asks for, whether its body is wanted, and the
// response. Knows the Bazel cache protocol, the WebDAV subset that sccache uses, and the pages.
//
//     GET, HEAD   /ac/KEY /cas/KEY /dav/PATH    200 | 404
//     PUT         the same                      201 stored | 200 there already, replaced, or the first value kept
//     PROPFIND    /dav/PATH                     207; every path that ends in "/" is a collection
//     MKCOL       /dav/PATH                     201, and nothing is made: collections are virtual
//     GET, HEAD   /status /metrics /healthz /
//
// Bodies may come zstd-compressed (Content-Encoding) and go so when the client accepts it.

#include <optional>
#include <string>
#include <string_view>

#include "cache/server/service.h"
#include "cache/server/target.h"

namespace kiln {

enum class Method { get, head, put, propfind, mkcol, options, other };

struct HttpHead {
    Method method = Method::other;
    std::string_view target;
    std::string_view authorization;     // the field's value; empty: none
    std::string_view content_encoding;  // of the body
    std::string_view accept_encoding;
    std::string_view depth;          // PROPFIND
    std::optional<uint64_t> length;  // of the body; nullopt: chunked
};

struct HttpResponse {
    unsigned status = 200;
    std::string fields;  // further header lines, each ended by CRLF
    const char* type = "application/octet-stream";
    Bytes body;
    std::optional<BlobFile> file;  // instead of a body
    Service::Lease lease;          // of what of it is in memory
    uint64_t length() const { return file ? file->size() : body.size(); }
};

// A request between its head and its body.
struct HttpWork {
    Target target;
    Caller caller;
    Method method = Method::other;
    uint64_t most = 0;    // bytes of body to take, as sent
    bool unpack = false;  // the body is zstd
    bool pack = false;    // the client takes zstd
    bool deep = false;    // PROPFIND with Depth other than 0
    bool blocks = false;  // the answer may take long: not on a thread that serves sockets
};

// Where pages come from; main wires them.
struct HttpPages {
    std::function<std::string()> status;
    std::function<std::string()> metrics;
};

class HttpFace {
public:
    // `service` and `access` outlive this object. `access()` gives the tokens of now.
    HttpFace(Service& service, std::function<std::shared_ptr<const Access>()> access, HttpPages pages)
        : service_(service), access_(std::move(access)), pages_(std::move(pages)) {}

    // Fills `work`. A response makes the body unwanted: roles and limits are checked before any of it is read.
    std::optional<HttpResponse> plan(const HttpHead& head, HttpWork& work);
    // nullopt, only for work that does not block: it would, after all; ask again with `blocks` where that is no harm.
    std::optional<HttpResponse> answer(const HttpWork& work, ByteView body);
    HttpResponse refused(const Refused& refused) const;
    Service& service() { return service_; }

private:
    std::optional<HttpResponse> get(const HttpWork& work);
    HttpResponse put(const HttpWork& work, ByteView body);
    HttpResponse propfind(const HttpWork& work);
    HttpResponse page(const HttpWork& work);
    HttpResponse bytes(const HttpWork& work, Answer<std::optional<Bytes>> found);
    HttpResponse leased(const HttpWork& work, HttpResponse response);

    Service& service_;
    std::function<std::shared_ptr<const Access>()> access_;
    HttpPages pages_;
};

// The token in an Authorization field: "Bearer T", or the password of "Basic …" (ccache, browsers). Empty: none. nullopt: a
// field that is neither.
std::optional<std::string> token_of(std::string_view authorization);

const char* reason_of(unsigned status);

}  // namespace kiln
