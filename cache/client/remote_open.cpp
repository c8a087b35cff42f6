#include "cache/client/remote_open.h"

#include <cstdlib>

#include "cache/client/chaos_remote.h"
#include "cache/client/grpc_remote.h"
#include "cache/client/http_remote.h"
#include "cache/client/private_file.h"
#include "compiler/base/jobs.h"

namespace kiln {

Result<std::string> remote_token() {
    if (const char* file = std::getenv("KILN_CACHE_TOKEN_FILE"); file != nullptr && *file != '\0') {
        const auto text = read_private_file(file, "KILN_CACHE_TOKEN_FILE", 8192);
        KILN_TRY(text);
        return token_of(*text, std::string("KILN_CACHE_TOKEN_FILE ") + file);
    }
    if (const char* token = std::getenv("KILN_CACHE_TOKEN"); token != nullptr && *token != '\0')
        return token_of(token, "KILN_CACHE_TOKEN");
    return std::string();
}

Result<std::unique_ptr<RemoteStore>> open_remote_store(const RemoteUrl& url, const RemoteOptions& options) {
    if (url.scheme == "http" || url.scheme == "https") {
        HttpOptions http;
        http.timeout = options.timeout;
        http.token = options.token;
        http.ca_file = options.ca_file;
        http.no_proxy = url.loopback();  // a token that may go there in clear text goes nowhere else
        return HttpRemote::open(url, http, options.limits);
    }
    GrpcRemoteOptions grpc;
    grpc.timeout = options.timeout;
    grpc.token = options.token;
    grpc.interrupted = &interrupted;
    if (!options.ca_file.empty()) {
        const auto pem = read_authorities(options.ca_file, "KILN_CACHE_CA");
        KILN_TRY(pem);
        grpc.authority = *pem;
    }
    return open_grpc_remote(url, grpc, options.limits);
}

Result<std::unique_ptr<RemoteCache>> open_remote_cache(const RemoteUrl& url, const RemoteOptions& options) {
    std::unique_ptr<Signer> signer;
    std::unique_ptr<Verifier> verifier;
    if (!options.sign_file.empty()) {
        auto opened = Signer::open(options.sign_file);
        KILN_TRY(opened);
        signer = std::move(*opened);
    }
    if (!options.trust_file.empty()) {
        auto opened = Verifier::open(options.trust_file);
        KILN_TRY(opened);
        verifier = std::move(*opened);
    }
    auto store = open_remote_store(url, options);
    KILN_TRY(store);
    if (options.chaos) *store = std::make_unique<ChaosRemote>(std::move(*store), *options.chaos);
    return std::make_unique<RemoteCache>(std::move(*store), options.breaker, options.limits, std::move(signer),
                                         std::move(verifier));
}

}  // namespace kiln
