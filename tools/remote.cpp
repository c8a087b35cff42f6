#include "tools/remote.h"

#include <cmath>
#include <cstdlib>

#include "cache/client/remote_open.h"
#include "cache/disk_store.h"
#include "compiler/space/count.h"

namespace kiln {

const Option option_cache_timeout{"--cache-timeout", nullptr, "SECONDS",
                                  "how long to wait for an answer of a cache server; default $KILN_CACHE_TIMEOUT, else 5"};
const Option option_cache_read_only{"--cache-read-only", nullptr, nullptr,
                                    "send nothing to the cache server; also when $KILN_CACHE_READ_ONLY is 1"};

namespace {

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

Result<std::chrono::milliseconds> seconds(const std::string& what, const std::string& text) {
    char* end = nullptr;
    const bool plain = !text.empty() && text.size() < 12 && text.find_first_not_of("0123456789.") == std::string::npos;
    const double value = plain ? std::strtod(text.c_str(), &end) : -1;
    if (!plain || *end != '\0' || value < 0.01 || value > 3600)
        return Error{Fault::usage, what + " takes seconds from 0.01 to 3600, not '" + text + "'"};
    return std::chrono::milliseconds(std::lround(value * 1000));
}

std::string n(uint64_t value) { return Count(value).grouped(); }

}  // namespace

Result<CachePlaces> CachePlaces::of(const Args& args) {
    std::vector<std::string> words = args.values("--cache");
    if (words.empty()) {
        std::string all = environment("KILN_CACHE");
        while (!all.empty()) {
            const size_t comma = std::min(all.find(','), all.size());
            if (comma != 0) words.push_back(all.substr(0, comma));
            all.erase(0, comma + 1);
        }
    }
    CachePlaces places;
    places.folder = default_cache_folder();
    bool folder_named = false;
    for (const std::string& word : words) {
        if (is_url(word)) {
            KILN_TRY(RemoteUrl::parse(word));
            if (!places.url.empty()) return Error{Fault::usage, "two cache servers are named; one will do"};
            places.url = word;
            continue;
        }
        if (folder_named) return Error{Fault::usage, "two cache folders are named, '" + places.folder + "' and '" + word + "'"};
        folder_named = true;
        places.folder = word;
    }
    if (places.folder == "none") places.folder.clear();
    return places;
}

namespace {

struct Settings {
    RemoteUrl where;
    RemoteOptions remote;
    LayeredOptions layers;
};

Result<Settings> settings_of(const Args& args, const std::string& url) {
    const auto where = RemoteUrl::parse(url);
    KILN_TRY(where);
    Settings out;
    out.where = *where;
    const std::string asked = args.value("--cache-timeout", environment("KILN_CACHE_TIMEOUT"));
    if (!asked.empty()) {
        const auto timeout = seconds(args.has("--cache-timeout") ? "--cache-timeout" : "KILN_CACHE_TIMEOUT", asked);
        KILN_TRY(timeout);
        out.remote.timeout = *timeout;
    }
    if (const std::string drain = environment("KILN_CACHE_DRAIN"); !drain.empty()) {
        const auto time = seconds("KILN_CACHE_DRAIN", drain);
        KILN_TRY(time);
        out.layers.drain = *time;
    }
    const std::string read_only = environment("KILN_CACHE_READ_ONLY");
    out.layers.write = !args.has("--cache-read-only") && (read_only.empty() || read_only == "0");
    const auto token = remote_token();
    KILN_TRY(token);
    out.remote.token = *token;
    if (!out.remote.token.empty() && !where->tls() && !where->loopback() && environment("KILN_CACHE_PLAIN_TOKEN") != "1")
        return Error{Fault::usage, "cache '" + where->text() + "': a token is not sent in clear text over a network; use " +
                                       (where->scheme == "http" ? "https" : "grpcs") + ", or set KILN_CACHE_PLAIN_TOKEN=1"};
    out.remote.ca_file = environment("KILN_CACHE_CA");
    out.remote.trust_file = environment("KILN_CACHE_TRUST");
    if (out.layers.write) out.remote.sign_file = environment("KILN_CACHE_SIGN");
    return out;
}

}  // namespace

Result<std::unique_ptr<LayeredStore>> open_remote(const Args& args, const std::string& url, Store& local, LayeredStore::Has has,
                                                  const Chaos* chaos) {
    auto settings = settings_of(args, url);
    KILN_TRY(settings);
    if (chaos != nullptr) settings->remote.chaos = *chaos;
    auto remote = open_remote_cache(settings->where, settings->remote);
    KILN_TRY(remote);
    return std::make_unique<LayeredStore>(local, std::move(has), std::move(*remote), settings->layers);
}

Result<RemoteProbe> probe_remote(const Args& args, const std::string& url) {
    const auto settings = settings_of(args, url);
    KILN_TRY(settings);
    const auto store = open_remote_store(settings->where, settings->remote);
    KILN_TRY(store);
    // A question that nobody has asked before and nobody will: its answer is a miss.
    const Digest key = KeyHasher("kiln.probe.v1").field("name", url).finish();
    RemoteProbe probe;
    probe.name = (*store)->name();
    for (int i = 0; i < 4; ++i) {
        const auto began = std::chrono::steady_clock::now();
        const RemoteAnswer answer = (*store)->get_actions({&key, 1}).front();
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
        (i == 0 ? probe.first_ms : probe.ms) = i < 2 ? took.count() : std::min(probe.ms, took.count());
        probe.reads = answer.kind == RemoteAnswer::Kind::absent || answer.kind == RemoteAnswer::Kind::found;
        probe.problem = answer.problem;
        if (!probe.reads) break;
    }
    return probe;
}

std::string remote_warning(const RemoteCache& remote) {
    const RemoteCounters did = remote.counters();
    std::string what;
    const auto add = [&](uint64_t count, const char* text) {
        if (count != 0) what += (what.empty() ? "" : ", ") + n(count) + text;
    };
    add(did.failures, " requests failed");
    add(did.corrupt, " answers were wrong and were not used");
    add(did.untrusted, " records were not signed by who is trusted and were not used");
    add(did.kept_first, " records differ from those that the server has and keeps");
    if (did.may_not_read) what += std::string(what.empty() ? "" : ", ") + "this token may not read";
    if (what.empty()) return {};
    add(did.not_asked, " entries were not asked for any more");
    return "the cache server " + remote.name() + " was done without in part: " + what +
           (did.problem.empty() ? "" : "; first: " + did.problem);
}

std::string remote_note(const RemoteCache& remote) {
    if (!remote.counters().may_not_write) return {};
    return "the cache server " + remote.name() + " lets this token read only; nothing was sent";
}

std::string remote_text(const RemoteCache& remote) {
    const RemoteCounters did = remote.counters();
    return "  " + remote.name() + ": hits " + n(did.hits) + ", misses " + n(did.misses) + ", failures " + n(did.failures) + ", " +
           n(did.bytes_in) + " bytes read; sent " + n(did.sent) + ", already there " + n(did.already_there) + ", not sent " +
           n(did.not_sent) + ", " + n(did.bytes_out) + " bytes\n";
}

void remote_json(Json& json, const RemoteCache& remote) {
    const RemoteCounters did = remote.counters();
    json.key("remote").object().text("server", remote.name());
    json.number("hits", did.hits).number("misses", did.misses).number("failures", did.failures);
    json.number("corrupt", did.corrupt).number("untrusted", did.untrusted).number("not_asked", did.not_asked);
    json.number("bytes_in", did.bytes_in).number("sent", did.sent).number("already_there", did.already_there);
    json.number("kept_first", did.kept_first).number("not_sent", did.not_sent).number("bytes_out", did.bytes_out).end();
}

}  // namespace kiln
