#include "tools/session.h"

#include "cache/disk_store.h"
#include "tools/console.h"

namespace kiln {

const Option option_scene{"--scene", nullptr, "FILE", "keep only what this scene needs", true};
const Option option_cache{"--cache", nullptr, "DIR", "cache folder, or 'none'; default $XDG_CACHE_HOME/kiln"};
const Option option_jobs{"--jobs", "-j", "N", "threads; default one a core"};
const Option option_json{"--json", nullptr, nullptr, "print one JSON document on standard output"};
const Option option_shader{"--shader", nullptr, "NAME", "which shader, where there are several"};

Result<std::unique_ptr<Session>> Session::open(const Args& args) {
    auto session = std::make_unique<Session>();
    const auto threads = args.number("--jobs", 0, 1, 1024);
    KILN_TRY(threads);
    session->jobs = std::make_unique<Jobs>(static_cast<unsigned>(*threads));
    const std::string where = args.value("--cache", default_cache_folder());
    if (where != "none" && !where.empty()) {
        auto store = DiskStore::open(where);
        if (store.ok())
            session->store = std::move(*store);
        else
            print_note("warning: building without a cache: " + store.error().message);
    }
    if (!session->store) session->store = std::make_unique<NoStore>();
    session->tools = make_toolchain();
    session->context = std::make_unique<PassContext>(
        PassContext{session->files, *session->store, *session->tools, *session->jobs, terminal_progress()});
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
