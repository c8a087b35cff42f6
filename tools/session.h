#pragma once
// What every verb that runs the pass needs: disk, cache, tools, jobs, made from the command line.

#include <memory>

#include "compiler/pass.h"
#include "tools/args.h"

namespace kiln {

struct Session {
    DiskFiles files;
    std::unique_ptr<Store> store;
    std::unique_ptr<Toolchain> tools;
    std::unique_ptr<Jobs> jobs;
    std::unique_ptr<PassContext> context;

    // Opens the cache that --cache names ("none": only this run's memory); one that cannot be opened is a warning.
    static Result<std::unique_ptr<Session>> open(const Args& args);
};

// Options shared by verbs; `scene`, `cache` and `jobs` read by build_options and Session::open.
extern const Option option_scene, option_cache, option_jobs, option_json, option_shader;

Result<BuildOptions> build_options(const Args& args);

// Prints what the build reported; 0, or the exit code of its failure.
int report_build(const Build& build);

}  // namespace kiln
