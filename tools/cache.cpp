// kiln cache: what the local store holds; checking it, bounding it, emptying it.
#include "cache/disk_store.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

std::string line(const char* name, const DiskUse& use) {
    return std::string("  ") + name + ": " + Count(use.entries).grouped() + " entries, " + Count(use.bytes).grouped() +
           " bytes\n";
}

void use(Json& json, const char* name, const DiskUse& of) {
    json.key(name).object().number("entries", of.entries).number("bytes", of.bytes).number("charged", of.charged).end();
}

std::string of_limit(uint64_t charged, uint64_t limit) {
    const std::string bound = limit == 0 ? "no bound" : "a bound of " + Count(limit).grouped();
    return "  counted in whole pages: " + Count(charged).grouped() + " bytes, " + bound + "\n";
}

int show_stats(const DiskStore& store, const Args& args, const Result<DiskStore::Stats>& stats, bool removed) {
    if (!stats.ok()) return print_error(stats.error());
    const uint64_t limit = store.options().limit;
    if (args.has("--json")) {
        Json json;
        json.object().text("folder", store.folder());
        use(json, "action", stats->action);
        use(json, "blob", stats->blob);
        use(json, "temporary", stats->temporary);
        use(json, "quarantine", stats->quarantine);
        json.number("charged", stats->entries().charged).number("limit", limit).end();
        return finish(json.take());
    }
    std::string out =
        store.folder() + (removed ? ": removed" : "") + "\n" + line("actions", stats->action) + line("blobs", stats->blob);
    if (stats->temporary.entries != 0) out += line("being written", stats->temporary);
    if (stats->quarantine.entries != 0) out += line("quarantined", stats->quarantine);
    if (!removed) out += of_limit(stats->entries().charged, limit);
    return finish(out);
}

std::string damage_text(const DiskStore::Damage& damage, const char* what) {
    return damage.path + ": " + what + ": " + damage.reason + "\n" +
           (damage.kept.empty() ? "" : "  moved to " + damage.kept + "\n");
}

int run_verify(DiskStore& store, const Args& args) {
    const auto found = store.verify();
    if (!found.ok()) return print_error(found.error());
    const int code = !found->damaged.empty()      ? static_cast<int>(Fault::mismatch)
                     : !found->unreadable.empty() ? static_cast<int>(Fault::environment)
                                                  : 0;
    if (args.has("--json")) {
        Json json;
        json.object().text("folder", store.folder());
        use(json, "checked", found->checked);
        for (const auto& [name, list] : {std::pair{"damaged", &found->damaged}, std::pair{"unreadable", &found->unreadable}}) {
            json.key(name).array();
            for (const auto& d : *list)
                json.object().text("path", d.path).text("reason", d.reason).text("quarantined", d.kept).end();
            json.end();
        }
        json.end();
        return finish(json.take(), code);
    }
    std::string out;
    for (const auto& damage : found->damaged) out += damage_text(damage, "damaged");
    for (const auto& damage : found->unreadable) out += damage_text(damage, "not readable");
    out += store.folder() + ": " + Count(found->checked.entries).grouped() + " entries, " +
           Count(found->checked.bytes).grouped() + " bytes read, " + Count(uint64_t{found->damaged.size()}).grouped() +
           " damaged, " + Count(uint64_t{found->unreadable.size()}).grouped() + " not readable\n";
    return finish(out, code);
}

int run_gc(DiskStore& store, const Args& args) {
    // A file's worth of bytes no longer than the largest number stands for "no bound": only old temporary files go.
    uint64_t target = store.options().limit == 0 ? ~uint64_t{0} : low_watermark(store.options().limit);
    if (args.has("--max-size")) {
        const auto given = parse_size("--max-size", args.value("--max-size"));
        if (!given.ok()) return print_error(given.error());
        target = *given;
    }
    const auto shrunk = store.gc(target);
    if (!shrunk.ok()) return print_error(shrunk.error());
    const DiskUse after{shrunk->before.entries - shrunk->evicted.entries, shrunk->before.bytes - shrunk->evicted.bytes,
                        shrunk->before.charged - shrunk->evicted.charged};
    if (args.has("--json")) {
        Json json;
        json.object().text("folder", store.folder()).number("limit", store.options().limit);
        use(json, "before", shrunk->before);
        use(json, "evicted", shrunk->evicted);
        use(json, "after", after);
        json.end();
        return finish(json.take());
    }
    return finish(store.folder() + "\n" + line("evicted", shrunk->evicted) + line("kept", after) +
                  of_limit(after.charged, store.options().limit));
}

int show_remote(const Args& args, const std::string& url) {
    const auto probe = probe_remote(args, url);
    if (!probe.ok()) return print_error(probe.error());
    const int code = probe->reads ? 0 : static_cast<int>(Fault::environment);
    if (args.has("--json")) {
        Json json;
        json.object().text("server", probe->name).key("reads").boolean(probe->reads);
        json.text("problem", probe->problem).number("first_ms", probe->first_ms).number("ms", probe->ms).end();
        return finish(json.take(), code);
    }
    if (!probe->reads) return print_error({Fault::environment, "the cache server " + probe->name + ": " + probe->problem});
    char times[100];
    std::snprintf(times, sizeof times, "  answers in %.1f ms, with the connection %.1f ms; this token may read\n", probe->ms,
                  probe->first_ms);
    return finish(probe->name + "\n" + times +
                  "  what it holds, it shows to its administrator (kiln-cached: /status, /metrics)\n");
}

int run_cache(const Args& args) {
    const std::string& what = args.words().front();
    if (what != "stats" && what != "verify" && what != "gc" && what != "clear")
        return print_error({Fault::usage, "kiln cache: '" + what + "': say stats, verify, gc or clear"});
    if (args.has("--max-size") && what != "gc") return print_error({Fault::usage, "kiln cache: --max-size belongs to gc"});
    const auto places = CachePlaces::of(args);
    if (!places.ok()) return print_error(places.error());
    if (args.has("--cache") && !places->url.empty()) {
        if (what == "stats") return show_remote(args, places->url);
        return print_error({Fault::usage, "kiln cache " + what + ": it looks after folders; a cache server looks after itself"});
    }
    const std::string& folder = places->folder;
    if (folder.empty()) return print_error({Fault::usage, "kiln cache: no home folder; name the cache with --cache DIR"});
    const auto options = cache_options(args);
    if (!options.ok()) return print_error(options.error());
    const auto store = DiskStore::open(folder, *options);
    if (!store.ok()) return print_error(store.error());
    if (what == "verify") return run_verify(**store, args);
    if (what == "gc") return run_gc(**store, args);
    return show_stats(**store, args, what == "clear" ? (*store)->clear() : (*store)->stats(), what == "clear");
}

}  // namespace

const Verb verb_cache{"cache",
                      "stats|verify|gc|clear [--cache DIR|URL] [--cache-size SIZE] [--max-size SIZE] [--json]",
                      "show what the cache holds, check every bit of it, shrink it or empty it",
                      1,
                      1,
                      {option_cache,
                       option_cache_size,
                       option_cache_timeout,
                       {"--max-size", nullptr, "SIZE", "gc: how much may stay; default nine tenths of the bound"},
                       option_json},
                      "kiln cache verify && kiln cache gc --max-size 500M",
                      run_cache};

}  // namespace kiln
