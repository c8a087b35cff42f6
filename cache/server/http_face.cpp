// Whoever may not write is told so before the body is read; the roles are checked again when it is stored, by the service.
#include "cache/server/http_face.h"

#include <algorithm>
#include <array>
#include <ctime>

#include "cache/zstd.h"

namespace kiln {

namespace {

constexpr uint64_t lease_least = 32 * 1024;
constexpr uint64_t pack_least = 512, pack_most = uint64_t{4} << 20;  // worth compressing; small enough to do in memory

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equal_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

std::optional<std::string> decode_base64(std::string_view text) {
    std::string out;
    uint32_t value = 0;
    unsigned bits = 0;
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (const char c : text) {
        const size_t digit = digits.find(c);
        if (digit == std::string_view::npos) return std::nullopt;
        value = value << 6 | static_cast<uint32_t>(digit);
        bits += 6;
        if (bits >= 8) out += static_cast<char>(value >> (bits -= 8) & 0xff);
    }
    return out;
}

// "zstd" among the codings of a list and not given weight 0. Wildcards are not taken: nobody who wants zstd says "*".
bool accepts_zstd(std::string_view list) {
    while (!list.empty()) {
        const size_t comma = std::min(list.find(','), list.size());
        std::string item;
        for (const char c : list.substr(0, comma))
            if (c != ' ' && c != '\t') item += lower(c);
        list.remove_prefix(std::min(comma + 1, list.size()));
        if (item == "zstd") return true;
        if (item.substr(0, 7) == "zstd;q=") return item.find_first_not_of("0.", 7) != std::string::npos;
    }
    return false;
}

HttpResponse text(unsigned status, std::string_view message) {
    HttpResponse response;
    response.status = status;
    response.type = "text/plain; charset=utf-8";
    response.body.assign(message.begin(), message.end());
    response.body.push_back('\n');
    return response;
}

HttpResponse not_allowed(const char* allow) {
    HttpResponse response = text(405, "this cannot be done here");
    response.fields = std::string("Allow: ") + allow + "\r\n";
    return response;
}

}  // namespace

std::optional<std::string> token_of(std::string_view authorization) {
    if (authorization.empty()) return std::string();
    const size_t space = authorization.find(' ');
    if (space == std::string_view::npos) return std::nullopt;
    std::string_view value = authorization.substr(space);
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    const std::string_view scheme = authorization.substr(0, space);
    if (equal_ignoring_case(scheme, "bearer") && !value.empty()) return std::string(value);
    if (!equal_ignoring_case(scheme, "basic")) return std::nullopt;
    const auto pair = decode_base64(value);
    const size_t colon = pair ? pair->find(':') : std::string::npos;
    if (colon == std::string::npos) return std::nullopt;
    return pair->substr(colon + 1);
}

const char* reason_of(unsigned status) {
    switch (status) {
        case 200:
            return "OK";
        case 201:
            return "Created";
        case 204:
            return "No Content";
        case 207:
            return "Multi-Status";
        case 400:
            return "Bad Request";
        case 401:
            return "Unauthorized";
        case 403:
            return "Forbidden";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 408:
            return "Request Timeout";
        case 411:
            return "Length Required";
        case 413:
            return "Payload Too Large";
        case 415:
            return "Unsupported Media Type";
        case 417:
            return "Expectation Failed";
        case 431:
            return "Request Header Fields Too Large";
        case 500:
            return "Internal Server Error";
        case 503:
            return "Service Unavailable";
        case 507:
            return "Insufficient Storage";
        default:
            return "Unknown";
    }
}

HttpResponse HttpFace::refused(const Refused& refused) const {
    constexpr std::array<unsigned, 8> status{400, 401, 403, 404, 413, 503, 507, 500};  // by Refusal
    HttpResponse response = text(status[static_cast<size_t>(refused.why)], refused.message);
    if (refused.why == Refusal::unauthenticated)
        response.fields = "WWW-Authenticate: Bearer realm=\"kiln-cached\"\r\nWWW-Authenticate: Basic realm=\"kiln-cached\"\r\n";
    if (refused.why == Refusal::busy) response.fields = "Retry-After: 1\r\n";
    return response;
}

std::optional<HttpResponse> HttpFace::plan(const HttpHead& head, HttpWork& work) {
    work = HttpWork();
    work.method = head.method;
    const auto target = parse_target(head.target);
    const auto token = token_of(head.authorization);
    const auto access = access_();
    work.caller = token ? access->caller(*token, std::time(nullptr)) : Caller();
    if (!target) return refused(service_.refuse("", work.caller, Refusal::bad_request, "there is no such path"));
    work.target = *target;
    work.pack = accepts_zstd(head.accept_encoding);
    work.deep = head.depth != "0";
    using What = Target::What;
    const bool store = target->what == What::action || target->what == What::blob || target->what == What::dav;
    const bool dav = target->what == What::dav;
    const bool options = work.method == Method::options && dav;
    if (!store && work.method != Method::get && work.method != Method::head) return not_allowed("GET, HEAD");
    // Neither takes a body, and nobody has been asked for a token yet.
    if ((!store || options) && head.length && *head.length > work.most)
        return refused(service_.refuse("", work.caller, Refusal::too_large, "this takes no body"));
    if (options) return std::nullopt;
    if (!store) {
        work.blocks = target->what != What::health && target->what != What::root;
        return std::nullopt;
    }
    const bool reads = work.method == Method::get || work.method == Method::head || (dav && work.method == Method::propfind);
    const bool writes = work.method == Method::put || (dav && work.method == Method::mkcol);
    if (!reads && !writes) return not_allowed(dav ? "GET, HEAD, PUT, PROPFIND, MKCOL, OPTIONS" : "GET, HEAD, PUT");
    const Role role = reads ? Role::read : target->what == What::blob ? Role::cas_write : Role::ac_write;
    const auto instance = service_.enter(work.caller, target->instance, role);
    if (!instance.ok()) return refused(instance.refused());
    // A PROPFIND may carry a list of properties, which is not read further than to skip it.
    const ServiceLimits& limits = service_.limits();
    if (work.method == Method::propfind) work.most = 64 * 1024;
    if (work.method == Method::put)
        work.most = target->what == What::blob ? limits.blob : dav || instance->opaque ? limits.opaque_action : limits.action;
    if (head.length && *head.length > work.most)
        return refused(
            service_.refuse(instance->name, work.caller, Refusal::too_large, "the body is larger than the server takes"));
    if (work.method == Method::put && dav && target->collection) return not_allowed("PROPFIND, MKCOL, OPTIONS");
    if (work.method == Method::put && !head.content_encoding.empty() && !equal_ignoring_case(head.content_encoding, "identity")) {
        if (!equal_ignoring_case(head.content_encoding, "zstd")) return text(415, "bodies come plain or as zstd");
        work.unpack = true;
    }
    work.blocks = target->what != What::blob || work.method == Method::put || work.pack;
    return std::nullopt;
}

std::optional<HttpResponse> HttpFace::answer(const HttpWork& work, ByteView body) {
    using What = Target::What;
    if (work.target.what == What::status || work.target.what == What::metrics || work.target.what == What::health ||
        work.target.what == What::root)
        return page(work);
    switch (work.method) {
        case Method::get:
        case Method::head:
            return get(work);
        case Method::put:
            return put(work, body);
        case Method::propfind:
            return propfind(work);
        case Method::mkcol:
            return text(201, "collections need no making");
        default:
            break;
    }
    HttpResponse response;
    response.fields = "Allow: GET, HEAD, PUT, PROPFIND, MKCOL, OPTIONS\r\nDAV: 1\r\n";
    return response;
}

HttpResponse HttpFace::bytes(const HttpWork& work, Answer<std::optional<Bytes>> found) {
    if (!found.ok()) return refused(found.refused());
    if (!*found) return text(404, "not here");
    HttpResponse response;
    response.body = std::move(**found);
    if (work.pack && response.body.size() >= pack_least && response.body.size() <= pack_most) {
        response.body = zstd_compress(response.body, 1);
        response.fields = "Content-Encoding: zstd\r\nVary: Accept-Encoding\r\n";
    }
    return leased(work, std::move(response));
}

// A client that reads slowly keeps what it reads in memory. What the kernel's buffers take at once is not worth the counting.
HttpResponse HttpFace::leased(const HttpWork& work, HttpResponse response) {
    const uint64_t held = response.file ? response.file->memory().size() : response.body.size();
    if (held <= lease_least || work.method == Method::head) return response;
    auto lease = service_.lease_response(held);
    if (!lease.ok())
        return refused(service_.refuse(work.target.instance, work.caller, lease.refused().why, lease.refused().message));
    response.lease = std::move(*lease);
    return response;
}

std::optional<HttpResponse> HttpFace::get(const HttpWork& work) {
    const Target& t = work.target;
    if (t.what == Target::What::dav) {
        if (t.collection) return text(404, "a collection has no content");
        return bytes(work, service_.file(work.caller, t.instance, t.path));
    }
    if (t.what == Target::What::action) return bytes(work, service_.action(work.caller, t.instance, t.key));
    bool slow = false;
    auto found = service_.blob(work.caller, t.instance, t.key, work.blocks ? nullptr : &slow);
    if (slow) return std::nullopt;
    if (!found.ok()) return refused(found.refused());
    if (!*found) return text(404, "not here");
    if (work.pack && work.method == Method::get && (*found)->size() >= pack_least && (*found)->size() <= pack_most) {
        auto all = (*found)->all();
        if (!all.ok()) return refused({Refusal::failed, "the cache's disk failed"});
        return bytes(work, std::optional(std::move(*all)));
    }
    HttpResponse response;
    response.file = std::move(**found);
    return leased(work, std::move(response));
}

HttpResponse HttpFace::put(const HttpWork& work, ByteView body) {
    const Target& t = work.target;
    Bytes unpacked;
    Service::Lease lease;
    if (work.unpack) {
        const auto grow = [&](uint64_t capacity) {
            lease = Service::Lease();
            auto wanted = service_.lease(capacity);
            if (!wanted.ok()) return false;
            lease = std::move(*wanted);
            return true;
        };
        const Unpacked how = zstd_unpack(body, work.most, unpacked, grow);
        if (how == Unpacked::damaged)
            return refused(service_.refuse(t.instance, work.caller, Refusal::bad_request, "the body is not zstd"));
        if (how == Unpacked::too_large)
            return refused(
                service_.refuse(t.instance, work.caller, Refusal::too_large, "the body is larger than the server takes"));
        if (how == Unpacked::no_room)
            return refused(service_.refuse(t.instance, work.caller, Refusal::busy, "too many bodies in flight"));
        body = unpacked;
    }
    const auto written = t.what == Target::What::blob     ? service_.put_blob(work.caller, t.instance, {t.key, body.size()}, body)
                         : t.what == Target::What::action ? service_.put_action(work.caller, t.instance, t.key, body)
                                                          : service_.put_file(work.caller, t.instance, t.path, body);
    if (!written.ok()) return refused(written.refused());
    HttpResponse response;
    response.status = *written == Written::now ? 201 : 200;
    if (*written == Written::kept_first) response.fields = "X-Kiln-Kept: first\r\n";
    return response;
}

HttpResponse HttpFace::propfind(const HttpWork& work) {
    const Target& t = work.target;
    std::string properties;
    if (t.collection) {
        properties = "<D:resourcetype><D:collection/></D:resourcetype>";
    } else {
        const auto found = service_.file(work.caller, t.instance, t.path);
        if (!found.ok()) return refused(found.refused());
        if (!*found) return text(404, "not here");
        properties = "<D:resourcetype/><D:getcontentlength>" + std::to_string((*found)->size()) + "</D:getcontentlength>";
    }
    // The path's characters need no escaping, in XML or in a URL.
    const std::string href = (t.instance.empty() ? "/dav" : "/" + t.instance + "/dav") + (t.path.empty() ? "" : "/" + t.path) +
                             (t.collection ? "/" : "");
    HttpResponse response = text(
        207,
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<D:multistatus xmlns:D=\"DAV:\"><D:response><D:href>" + href +
            "</D:href><D:propstat><D:prop>" + properties +
            "<D:getlastmodified>Thu, 01 Jan 1970 00:00:00 GMT</D:getlastmodified></D:prop><D:status>HTTP/1.1 200 OK</D:status>"
            "</D:propstat></D:response></D:multistatus>");
    response.type = "application/xml; charset=utf-8";
    return response;
}

HttpResponse HttpFace::page(const HttpWork& work) {
    using What = Target::What;
    if (work.target.what == What::health) return text(200, "ok");
    if (work.target.what == What::root) return text(200, "kiln-cached: /ac/ /cas/ /dav/ /status /metrics /healthz");
    if (!work.caller.may_anywhere(Role::read)) {
        const Refusal why = work.caller.known() ? Refusal::forbidden : Refusal::unauthenticated;
        return refused(service_.refuse("", work.caller, why, "a token is needed for this"));
    }
    const bool status = work.target.what == What::status;
    const std::string content = status ? pages_.status() : pages_.metrics();
    HttpResponse response;
    response.body.assign(content.begin(), content.end());
    response.type = status ? "text/html; charset=utf-8" : "text/plain; version=0.0.4; charset=utf-8";
    if (status)
        response.fields =
            "Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'\r\n"
            "Referrer-Policy: no-referrer\r\nCache-Control: no-store\r\n";
    return response;
}

}  // namespace kiln
