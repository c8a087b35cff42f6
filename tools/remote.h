#pragma once
// The cache server of a verb: where it is, how it is asked, what came of it.

#include "cache/chaos_store.h"
#include "cache/client/layered_store.h"
#include "tools/args.h"
#include "tools/json.h"

namespace kiln {

// What --cache names, else KILN_CACHE (a comma between two): a folder, a URL, or both; "none" for no folder.
struct CachePlaces {
    std::string folder;  // empty: none
    std::string url;     // empty: none
    static Result<CachePlaces> of(const Args& args);
};

extern const Option option_cache_timeout, option_cache_read_only;

// A store of `local` and the server at `url`. Settings besides the two options come from the environment: KILN_CACHE_TIMEOUT and
// KILN_CACHE_DRAIN (seconds), KILN_CACHE_READ_ONLY, KILN_CACHE_TOKEN_FILE or KILN_CACHE_TOKEN, KILN_CACHE_CA, KILN_CACHE_TRUST,
// KILN_CACHE_SIGN. `chaos` may be null.
Result<std::unique_ptr<LayeredStore>> open_remote(const Args& args, const std::string& url, Store& local, LayeredStore::Has has,
                                                  const Chaos* chaos);

// What a question costs, and whether this token is answered.
struct RemoteProbe {
    std::string name;
    bool reads = false;
    std::string problem;          // when it does not
    double first_ms = 0, ms = 0;  // with the connection; the best of those after it
};
Result<RemoteProbe> probe_remote(const Args& args, const std::string& url);

// The one warning about a server, empty when there is nothing to say; a note where the token is good for reading alone.
std::string remote_warning(const RemoteCache& remote);
std::string remote_note(const RemoteCache& remote);

// For build summaries.
std::string remote_text(const RemoteCache& remote);
void remote_json(Json& json, const RemoteCache& remote);

}  // namespace kiln
