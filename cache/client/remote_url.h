#pragma once
// The address of a cache server: http, https, grpc or grpcs, host, port, and a path for HTTP or an instance name for gRPC.

#include <string>
#include <string_view>

#include "compiler/base/result.h"

namespace kiln {

struct RemoteUrl {
    std::string scheme, host;  // a host in brackets is an IPv6 address; the brackets are kept
    uint16_t port = 0;         // the scheme's own when none was given
    std::string path;          // "" or "/a/b", without a slash at the end

    // Refuses everything else that URLs may hold: user names and passwords, queries, fragments, escapes, `..`.
    // `what` is named in the Error ("cache", "--execute").
    static Result<RemoteUrl> parse(std::string_view text, const std::string& what = "cache");
    std::string text() const;
    bool tls() const { return scheme == "https" || scheme == "grpcs"; }
    bool loopback() const;
};

// True for a word that is meant as a URL and not as a folder.
bool is_url(std::string_view text);

}  // namespace kiln
