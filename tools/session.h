#pragma once
// What every verb that runs the pass needs: disk, cache, tools, jobs, made from the command line.

#include <memory>

#include "cache/chaos_store.h"
#include "cache/disk_options.h"
#include "compiler/pass.h"
#include "tools/args.h"
#include "tools/execute.h"
#include "tools/remote.h"

namespace kiln {

struct Session {
    DiskFiles files;
    std::unique_ptr<Store> store;          // local
    std::unique_ptr<LayeredStore> remote;  // in front of `store`, when a cache server is named
    std::unique_ptr<ChaosStore> chaos;     // in front of both, when --chaos asks for it
    std::unique_ptr<Toolchain> tools;
    std::unique_ptr<Jobs> jobs;
    std::unique_ptr<Execution> execution;  // with --execute
    std::unique_ptr<PassContext> context;

    // Opens the caches that --cache names; one that cannot be opened is a warning.
    static Result<std::unique_ptr<Session>> open(const Args& args);
    // Ends what goes to the cache server, and warns once if that was done without. Only the first call does anything.
    void finish();
    ~Session();  // finishes; says what --chaos did

private:
    bool finished_ = false;
};

// Options shared by verbs; `scene`, `cache` and `jobs` read by build_options and Session::open.
extern const Option option_scene, option_cache, option_jobs, option_json, option_shader, option_cache_size, option_chaos;

// "5G", "300M", "64k", "4096"; 0 is no bound. Binary units.
Result<uint64_t> parse_size(const std::string& what, const std::string& text);
// The bound from --cache-size, else KILN_CACHE_SIZE, else the default; flushing from KILN_CACHE_SYNC (none, file, folder), which
// is none for a build: to flush each entry made a cold build take up to half as long again, to save from a power cut what is
// checked when it is read.
Result<DiskOptions> cache_options(const Args& args);

Result<BuildOptions> build_options(const Args& args);

// Prints what the build reported; 0, or the exit code of its failure.
int report_build(const Build& build);

}  // namespace kiln
