// Configuration files from arbitrary bytes: what is accepted never opens a server to strangers without tokens.
#include <cstdlib>

#include "cache/server/config.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const auto settings = settings_of({reinterpret_cast<const char*>(data), size});
    if (!settings.ok()) return 0;
    Config config;
    if (!apply(*settings, config).ok() || !check(config).ok()) return 0;
    if (!is_loopback(config.http.address) && config.tokens.empty()) std::abort();
    if (config.folder.empty() || config.disk.limit == 0) std::abort();
    return 0;
}
