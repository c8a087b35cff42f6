#include "cache/server/http_head.h"

#include <ctime>

namespace kiln {

namespace {

std::string_view view(boost::string_view text) { return {text.data(), text.size()}; }

// The value of a field that may stand once; `times` says how often it does.
std::string_view field(const http::fields& fields, http::field name, size_t& times) {
    const auto range = fields.equal_range(name);
    times = static_cast<size_t>(std::distance(range.first, range.second));
    return times == 0 ? std::string_view() : view(range.first->value());
}

Method method_of(http::verb verb) {
    switch (verb) {
        case http::verb::get:
            return Method::get;
        case http::verb::head:
            return Method::head;
        case http::verb::put:
            return Method::put;
        case http::verb::propfind:
            return Method::propfind;
        case http::verb::mkcol:
            return Method::mkcol;
        case http::verb::options:
            return Method::options;
        default:
            return Method::other;
    }
}

// "Sun, 06 Nov 1994 08:49:37 GMT"
const std::string& date_now() {
    thread_local time_t of = 0;
    thread_local std::string text;
    const time_t now = std::time(nullptr);
    if (now != of) {
        tm parts{};
        ::gmtime_r(&now, &parts);
        char buffer[40];
        text.assign(buffer, std::strftime(buffer, sizeof buffer, "%a, %d %b %Y %H:%M:%S GMT", &parts));
        of = now;
    }
    return text;
}

}  // namespace

// Beast refuses two lengths that differ and a length beside "chunked"; what it lets pass (the same length twice, another
// transfer coding, which it takes for a request without a body) is refused here, since whatever stands in front of the server
// may see another end of the request.
HeadCheck check_head(const http::request_parser<http::buffer_body>& parser) {
    const auto& request = parser.get();
    HeadCheck check;
    size_t lengths = 0, codings = 0, hosts = 0, tokens = 0, encodings = 0, expects = 0, times = 0;
    const std::string_view length = field(request, http::field::content_length, lengths);
    field(request, http::field::transfer_encoding, codings);
    field(request, http::field::expect, expects);
    field(request, http::field::host, hosts);
    HttpHead& head = check.head;
    head.method = method_of(request.method());
    head.target = view(request.target());
    head.authorization = field(request, http::field::authorization, tokens);
    head.content_encoding = field(request, http::field::content_encoding, encodings);
    head.accept_encoding = field(request, http::field::accept_encoding, times);
    head.depth = field(request, http::field::depth, times);
    const bool chunked = codings == 1 && beast::iequals(request[http::field::transfer_encoding], "chunked");
    const auto refuse = [&](unsigned status) {
        check.status = status;
        return check;
    };
    const bool modern = request.version() == 11;
    if (!modern && request.version() != 10) return refuse(400);
    if (lengths > 1 || codings > 1 || (lengths != 0 && codings != 0) || (codings != 0 && (!chunked || !modern)))
        return refuse(400);
    if (length.find_first_not_of("0123456789") != std::string_view::npos || (lengths == 1 && length.empty())) return refuse(400);
    if ((modern && hosts != 1) || hosts > 1 || tokens > 1 || encodings > 1 || expects > 1) return refuse(400);
    if (lengths == 1)
        head.length = *parser.content_length();
    else if (codings == 0)
        head.length = 0;
    if (head.method == Method::put && lengths == 0 && codings == 0) return refuse(411);
    if (expects != 0) {
        if (!beast::iequals(request[http::field::expect], "100-continue")) return refuse(417);
        check.expects_continue = modern;
    }
    check.keep_alive = modern && request.keep_alive();
    return check;
}

bool has_folded_line(std::string_view head) {
    return head.find("\n ") != std::string_view::npos || head.find("\n\t") != std::string_view::npos;
}

std::string response_head(const HttpResponse& response, bool close) {
    std::string head;
    head.reserve(320);
    ((head += "HTTP/1.1 ") += std::to_string(response.status)) += ' ';
    ((head += reason_of(response.status)) += "\r\nServer: kiln-cached\r\nDate: ") += date_now();
    ((head += "\r\nContent-Type: ") += response.type) += "\r\nX-Content-Type-Options: nosniff\r\nContent-Length: ";
    (head += std::to_string(response.length())) += "\r\n";
    if (close) head += "Connection: close\r\n";
    return (head += response.fields) += "\r\n";
}

}  // namespace kiln
