#pragma once
// A client made from an address and its options.

#include "cache/chaos_store.h"
#include "cache/client/remote_cache.h"
#include "cache/client/remote_url.h"

namespace kiln {

struct RemoteOptions {
    std::chrono::milliseconds timeout{5000};
    std::string token;       // empty: none
    std::string ca_file;     // https, grpcs; empty: the system's
    std::string sign_file;   // private key: sign what is sent
    std::string trust_file;  // public keys: believe what they signed, and nothing else
    RemoteLimits limits;
    Breaker::Rules breaker;
    std::optional<Chaos> chaos;
};

// KILN_CACHE_TOKEN_FILE, else KILN_CACHE_TOKEN; empty when neither is set.
Result<std::string> remote_token();

// The one place that knows every protocol.
Result<std::unique_ptr<RemoteStore>> open_remote_store(const RemoteUrl& url, const RemoteOptions& options);
Result<std::unique_ptr<RemoteCache>> open_remote_cache(const RemoteUrl& url, const RemoteOptions& options);

}  // namespace kiln
