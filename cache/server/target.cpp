#include "cache/server/target.h"

#include <algorithm>

#include "cache/server/instances.h"

namespace kiln {

namespace {

constexpr size_t longest = 1024;

bool valid_path(std::string_view path) {
    if (path.size() > 512) return false;
    while (true) {
        const size_t slash = std::min(path.find('/'), path.size());
        const std::string_view segment = path.substr(0, slash);
        if (segment.empty() || segment == "." || segment == "..") return false;
        if (segment.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") !=
            std::string_view::npos)
            return false;
        if (slash == path.size()) return true;
        path.remove_prefix(slash + 1);
    }
}

// Splits "a/b/marker/rest" at the first segment that is `marker`. False when there is none.
bool split_at(std::string_view text, std::string_view marker, std::string_view& before, std::string_view& after) {
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('/', at), text.size());
        if (text.substr(at, end - at) == marker) {
            before = text.substr(0, at == 0 ? 0 : at - 1);
            after = text.substr(std::min(end + 1, text.size()));
            return at == 0 || at > 1;  // "//cas/…" names no instance
        }
        at = end + 1;
    }
    return false;
}

}  // namespace

const char* name_of(Target::What what) {
    switch (what) {
        case Target::What::action:
            return "ac";
        case Target::What::blob:
            return "cas";
        case Target::What::dav:
            return "dav";
        case Target::What::status:
            return "status";
        case Target::What::metrics:
            return "metrics";
        case Target::What::health:
            return "healthz";
        case Target::What::root:
            return "root";
    }
    return "root";
}

std::optional<Target> parse_target(std::string_view text) {
    if (text.empty() || text.size() > longest || text[0] != '/') return std::nullopt;
    text.remove_prefix(1);
    Target target;
    if (text.empty()) return target;
    using What = Target::What;
    for (const auto& [name, what] :
         {std::pair{std::string_view("status"), What::status}, {"metrics", What::metrics}, {"healthz", What::health}}) {
        if (text != name) continue;
        target.what = what;
        return target;
    }
    std::string_view before, after;
    for (const auto& [name, what] : {std::pair{std::string_view("cas"), What::blob}, {"ac", What::action}}) {
        if (!split_at(text, name, before, after)) continue;
        const auto key = Digest::from_hex(after);
        if (!key || !valid_instance_name(before)) continue;
        target.what = what;
        target.instance = before;
        target.key = *key;
        return target;
    }
    if (!split_at(text, "dav", before, after) || !valid_instance_name(before)) return std::nullopt;
    target.what = What::dav;
    target.instance = before;
    if (after.size() > 1 && after[0] == '/') after.remove_prefix(1);  // sccache, of an endpoint that ends in a slash
    target.collection = after.empty() || after.back() == '/';
    if (!after.empty() && after.back() == '/') after.remove_suffix(1);
    if (!after.empty() && !valid_path(after)) return std::nullopt;
    if (after.empty() && text.back() == '/' && text.substr(text.size() - std::min<size_t>(text.size(), 2)) == "//")
        return std::nullopt;
    target.path = after;
    return target;
}

}  // namespace kiln
