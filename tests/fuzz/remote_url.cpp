#include <cstdlib>

#include "cache/client/remote_url.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const std::string text(reinterpret_cast<const char*>(data), size);
    const auto url = RemoteUrl::parse(text);
    if (!url.ok()) return 0;
    const auto again = RemoteUrl::parse(url->text());
    if (!again.ok() || again->text() != url->text()) std::abort();
    for (const char* never : {"@", "?", "#", "%", "/../", " ", "\n", "\\"})
        if (url->text().find(never) != std::string::npos) std::abort();
    return 0;
}
