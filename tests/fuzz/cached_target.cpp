// Request targets from arbitrary bytes, and Authorization fields. What is accepted must be made of the characters that the
// grammar allows, and must say the same again when written out.
#include <cstdlib>

#include "cache/server/http_face.h"
#include "cache/server/instances.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto target = parse_target(text);
    if (target) {
        if (text.find("..") != std::string_view::npos && text.find("/../") != std::string_view::npos) std::abort();
        if (text.find('%') != std::string_view::npos || text.find('\0') != std::string_view::npos) std::abort();
        if (!valid_instance_name(target->instance)) std::abort();
        const std::string prefix = target->instance.empty() ? "" : "/" + target->instance;
        using What = Target::What;
        std::string again;
        if (target->what == What::blob || target->what == What::action)
            again = prefix + "/" + name_of(target->what) + "/" + target->key.hex();
        else if (target->what == What::dav)
            again = prefix + "/dav" + (target->path.empty() ? "" : "/" + target->path) +
                    (target->collection && !(target->path.empty() && text.back() != '/') ? "/" : "");
        else if (target->what == What::root)
            again = "/";
        else
            again = std::string("/") + name_of(target->what);
        if (again != text) std::abort();
    }
    const auto token = token_of(text);
    if (token && token->size() > size) std::abort();
    return 0;
}
