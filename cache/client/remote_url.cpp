#include "cache/client/remote_url.h"

#include <algorithm>

namespace kiln {

namespace {

const struct Scheme {
    const char* name;
    uint16_t port;
} schemes[] = {{"http", 80}, {"https", 443}, {"grpc", 8980}, {"grpcs", 8980}};

bool all_of(std::string_view text, const char* others) {
    return std::all_of(text.begin(), text.end(), [&](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view(others).find(c) != std::string_view::npos;
    });
}

}  // namespace

bool is_url(std::string_view text) { return text.find("://") != std::string_view::npos; }

Result<RemoteUrl> RemoteUrl::parse(std::string_view text, const std::string& what) {
    // The text is not repeated where it may hold a password.
    const auto wrong = [&](const std::string& why) {
        const bool secret = text.find('@') != std::string_view::npos;
        return Error{Fault::usage, what + " " + (secret ? std::string("address") : "'" + std::string(text) + "'") + ": " + why};
    };
    if (text.find('@') != std::string_view::npos)
        return wrong("no user or password belongs in it; tokens are read from files (kiln help environment)");
    if (text.size() > 2000) return wrong("it is too long");
    RemoteUrl url;
    const size_t colon = text.find("://");
    const std::string_view scheme = text.substr(0, colon == std::string_view::npos ? 0 : colon);
    for (const Scheme& known : schemes)
        if (scheme == known.name) {
            url.scheme = known.name;
            url.port = known.port;
        }
    if (url.scheme.empty()) return wrong("say a folder, http://, https://, grpc:// or grpcs://");
    std::string_view rest = text.substr(colon + 3);
    std::string_view host = rest.substr(0, rest.find('/'));
    std::string_view path = rest.substr(host.size());
    const size_t bracket = host.find(']');
    const size_t port = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
    if (port != std::string_view::npos) {
        const std::string digits(host.substr(port + 1));
        if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos ||
            std::stoul(digits) == 0 || std::stoul(digits) > 65535)
            return wrong("a port is a number from 1 to 65535");
        url.port = static_cast<uint16_t>(std::stoul(digits));
        host = host.substr(0, port);
    }
    const bool v6 = host.size() > 2 && host.front() == '[' && host.back() == ']';
    if (host.empty() || !(v6 ? all_of(host.substr(1, host.size() - 2), ":.") : all_of(host, "-._")))
        return wrong("no such host name");
    while (!path.empty() && path.back() == '/') path.remove_suffix(1);
    if (!all_of(path, "-._~/")) return wrong("a path is letters, digits, '-', '.', '_', '~' and '/'");
    if (path.find("//") != std::string_view::npos) return wrong("an empty part of a path");
    if ((std::string(path) + "/").find("/../") != std::string::npos || (std::string(path) + "/").find("/./") != std::string::npos)
        return wrong("'.' and '..' do not belong in a path");
    url.host = host;
    url.path = path;
    return url;
}

std::string RemoteUrl::text() const { return scheme + "://" + host + ":" + std::to_string(port) + path; }

bool RemoteUrl::loopback() const { return host == "localhost" || host == "[::1]" || host.rfind("127.", 0) == 0; }

}  // namespace kiln
