// --execute grpc://…: the nodes of an engine of the Remote Execution API.

#include <cstdlib>

#include "cache/client/private_file.h"
#include "cache/execute/reapi_engine.h"
#include "compiler/base/jobs.h"
#include "tools/execute.h"

namespace kiln {
namespace {

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

}  // namespace

Result<std::unique_ptr<Engine>> open_nodes(const std::vector<std::string>& addresses) {
    std::vector<RemoteUrl> nodes;
    bool clear = false;
    for (const std::string& address : addresses) {
        auto url = RemoteUrl::parse(address, "--execute");
        KILN_TRY(url);
        if (url->scheme != "grpc" && url->scheme != "grpcs")
            return Error{Fault::usage, "--execute '" + address + "': nodes are grpc:// or grpcs://"};
        clear |= !url->tls() && !url->loopback();
        nodes.push_back(std::move(*url));
    }
    ReapiOptions options;
    options.remote.interrupted = &interrupted;
    options.remote.timeout = std::chrono::seconds(20);
    if (const std::string file = environment("KILN_EXECUTE_TOKEN_FILE"); !file.empty()) {
        const auto text = read_private_file(file, "KILN_EXECUTE_TOKEN_FILE", 8192);
        KILN_TRY(text);
        const auto token = token_of(*text, "KILN_EXECUTE_TOKEN_FILE " + file);
        KILN_TRY(token);
        if (clear) return Error{Fault::usage, "--execute: a token is not sent in clear text over a network; use grpcs"};
        options.remote.token = *token;
    }
    if (const std::string file = environment("KILN_EXECUTE_CA"); !file.empty()) {
        const auto pem = read_authorities(file, "KILN_EXECUTE_CA");
        KILN_TRY(pem);
        options.remote.authority = *pem;
    }
    std::string properties = environment("KILN_EXECUTE_PLATFORM");
    while (!properties.empty()) {
        const std::string one = properties.substr(0, properties.find(','));
        properties.erase(0, one.size() + 1);
        const size_t equals = one.find('=');
        if (equals == std::string::npos || equals == 0)
            return Error{Fault::usage, "KILN_EXECUTE_PLATFORM takes NAME=VALUE,…, not '" + one + "'"};
        options.platform.emplace_back(one.substr(0, equals), one.substr(equals + 1));
    }
    return open_reapi_engine(nodes, options);
}

}  // namespace kiln
