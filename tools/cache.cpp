// kiln cache: what the local store holds, and emptying it.
#include "cache/disk_store.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

std::string as_text(const std::string& folder, const char* what, const DiskStore::Stats& stats) {
    const auto line = [](const char* name, const DiskStore::Use& use) {
        return std::string("  ") + name + ": " + Count(use.entries).grouped() + " entries, " + Count(use.bytes).grouped() +
               " bytes\n";
    };
    std::string out = folder + what + "\n" + line("actions", stats.action) + line("blobs", stats.blob);
    if (stats.temporary.entries != 0) out += line("being written", stats.temporary);
    return out;
}

std::string as_json(const std::string& folder, const DiskStore::Stats& stats) {
    Json json;
    json.object().text("folder", folder);
    const auto use = [&](const char* name, const DiskStore::Use& u) {
        json.key(name).object().number("entries", u.entries).number("bytes", u.bytes).end();
    };
    use("action", stats.action);
    use("blob", stats.blob);
    use("temporary", stats.temporary);
    json.end();
    return json.take();
}

int run_cache(const Args& args) {
    const std::string& what = args.words().front();
    if (what != "stats" && what != "clear") return print_error({Fault::usage, "kiln cache: '" + what + "': say stats or clear"});
    const std::string folder = args.value("--cache", default_cache_folder());
    if (folder.empty()) return print_error({Fault::usage, "kiln cache: no home folder; name the cache with --cache DIR"});
    auto store = DiskStore::open(folder);
    if (!store.ok()) return print_error(store.error());
    const auto stats = what == "clear" ? (*store)->clear() : (*store)->stats();
    if (!stats.ok()) return print_error(stats.error());
    return finish(args.has("--json") ? as_json(folder, *stats) : as_text(folder, what == "clear" ? ": removed" : "", *stats));
}

}  // namespace

const Verb verb_cache{"cache",
                      "stats|clear [--cache DIR] [--json]",
                      "show what the cache holds, or empty it",
                      1,
                      1,
                      {option_cache, option_json},
                      "kiln cache stats",
                      run_cache};

}  // namespace kiln
