#include "tools/session.h"

#include <unistd.h>

#include <cstdlib>

#include "cache/disk_store.h"
#include "tools/console.h"

namespace kiln {

const Option option_scene{"--scene", nullptr, "FILE", "keep only what this scene needs", true};
const Option option_cache{"--cache", nullptr, "DIR|URL",
                          "cache folder or 'none', and a cache server, http://, https:// or grpc://; default $KILN_CACHE, else "
                          "$XDG_CACHE_HOME/kiln",
                          true};
const Option option_jobs{"--jobs", "-j", "N", "threads; default one a core"};
const Option option_json{"--json", nullptr, nullptr, "print one JSON document on standard output"};
const Option option_shader{"--shader", nullptr, "NAME", "which shader, where there are several"};
const Option option_cache_size{"--cache-size", nullptr, "SIZE",
                               "bound of the cache, as 300M or 5G; 0 for none; default $KILN_CACHE_SIZE, else 5G"};
const Option option_chaos{
    "--chaos", nullptr, "SPEC",
    "for tests: hurt the cache, as seed=1,loss=0.1,error=0.1,flip=0.1,delay=2 (chances of 1, milliseconds)"};

Result<uint64_t> parse_size(const std::string& what, const std::string& text) {
    const Error wrong{Fault::usage, what + " takes a size such as 300M or 5G, not '" + text + "'"};
    std::string digits = text;
    uint64_t unit = 1;
    if (!digits.empty()) {
        const size_t scale = std::string("kKmMgGtT").find(digits.back());
        if (scale != std::string::npos) {
            unit = uint64_t{1} << (10 * (scale / 2 + 1));
            digits.pop_back();
        }
    }
    if (digits.empty() || digits.size() > 18 || digits.find_first_not_of("0123456789") != std::string::npos) return wrong;
    const uint64_t number = std::stoull(digits);
    if (number > (uint64_t{1} << 60) / unit) return wrong;
    return number * unit;
}

Result<DiskOptions> cache_options(const Args& args) {
    DiskOptions options;
    options.sync = Sync::none;
    if (const char* size = std::getenv("KILN_CACHE_SIZE"); args.has("--cache-size") || (size != nullptr && *size != '\0')) {
        const auto limit = args.has("--cache-size") ? parse_size("--cache-size", args.value("--cache-size"))
                                                    : parse_size("KILN_CACHE_SIZE", size);
        KILN_TRY(limit);
        options.limit = *limit;
    }
    if (const char* how = std::getenv("KILN_CACHE_SYNC"); how != nullptr && *how != '\0') {
        const std::string name = how;
        if (name != "none" && name != "file" && name != "folder")
            return Error{Fault::usage, "KILN_CACHE_SYNC is none, file or folder, not '" + name + "'"};
        options.sync = name == "none" ? Sync::none : name == "file" ? Sync::file : Sync::folder;
    }
    return options;
}

void Session::finish() {
    if (finished_ || !remote) return;
    finished_ = true;
    remote->finish();
    if (const std::string note = remote_note(remote->remote()); !note.empty()) print_note(note);
    if (const std::string warning = remote_warning(remote->remote()); !warning.empty()) print_note("warning: " + warning);
}

Session::~Session() {
    finish();
    if (!chaos) return;
    const ChaosStore::Counters did = chaos->counters();
    print_note("chaos: lost " + std::to_string(did.lost) + ", failed " + std::to_string(did.failed) + ", flipped " +
               std::to_string(did.flipped) + ", delayed " + std::to_string(did.delayed));
}

Result<std::unique_ptr<Session>> Session::open(const Args& args) {
    auto session = std::make_unique<Session>();
    const auto threads = args.number("--jobs", 0, 1, 1024);
    KILN_TRY(threads);
    session->jobs = std::make_unique<Jobs>(static_cast<unsigned>(*threads));
    const auto disk = cache_options(args);
    KILN_TRY(disk);
    const auto chaos = Chaos::parse(args.value("--chaos"));
    KILN_TRY(chaos);
    const auto places = CachePlaces::of(args);
    KILN_TRY(places);
    const std::string& where = places->folder;
    ChaosStore::Flip flip;
    LayeredStore::Has has;
    if (!where.empty()) {
        auto store = DiskStore::open(where, *disk);
        if (store.ok()) {
            flip = [on_disk = store->get()](Keyspace space, const Digest& key, uint64_t dice) {
                return flip_bit(on_disk->path_of(space, key), dice);
            };
            has = [on_disk = store->get()](Keyspace space, const Digest& key) {
                return ::access(on_disk->path_of(space, key).c_str(), F_OK) == 0;
            };
            session->store = std::move(*store);
        } else {
            print_note("warning: building without a cache: " + store.error().message);
        }
    }
    // What comes back from an engine has to be kept somewhere until the pass asks for it.
    if (!session->store && args.has("--execute")) session->store = std::make_unique<MemoryStore>();
    if (!session->store) session->store = std::make_unique<NoStore>();
    Store* store = session->store.get();
    if (!places->url.empty()) {
        auto remote = open_remote(args, places->url, *store, std::move(has), args.has("--chaos") ? &*chaos : nullptr);
        if (remote.ok()) {
            session->remote = std::move(*remote);
            store = session->remote.get();
        } else if (remote.error().fault == Fault::usage) {
            return remote.error();
        } else {
            print_note("warning: building without the cache server: " + remote.error().message);
        }
    }
    if (args.has("--chaos")) {
        session->chaos = std::make_unique<ChaosStore>(*store, *chaos, std::move(flip));
        store = session->chaos.get();
    }
    session->tools = make_toolchain();
    auto execution = Execution::open(args, *store, *session->tools);
    KILN_TRY(execution);
    session->execution = std::move(*execution);
    session->context =
        std::make_unique<PassContext>(PassContext{session->files, *store, *session->tools, *session->jobs, console_progress(),
                                                  session->execution ? session->execution->distributor.get() : nullptr});
    return session;
}

Result<BuildOptions> build_options(const Args& args) {
    BuildOptions options;
    options.manifest = args.words().front();
    if (options.manifest.empty()) return Error{Fault::usage, "the manifest's name is empty"};
    options.scenes = args.values("--scene");
    for (const std::string& scene : options.scenes)
        if (scene.empty()) return Error{Fault::usage, "--scene: the name of a file is missing"};
    for (const std::string& name : args.values("--target")) {
        const auto target = target_named(name);
        if (!target) {
            std::vector<std::string> names;
            for (const Target t : all_targets()) names.emplace_back(name_of(t));
            const std::string near = nearest(name, names);
            std::string known;
            for (const std::string& other : names) known += (known.empty() ? "; there is " : ", ") + other;
            return input_error("no target '" + name + "'" + (near.empty() ? known : "; did you mean '" + near + "'?"));
        }
        options.targets.push_back(*target);
    }
    options.debug = args.has("-g");
    options.parse_back = args.has("--parse-back");
    return options;
}

int report_build(const Build& build) {
    print_diags(build.diags);
    if (build.failed) return print_error(*build.failed);
    return build.diags.has_errors() ? static_cast<int>(Fault::input) : 0;
}

}  // namespace kiln
