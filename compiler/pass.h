#pragma once
// The pass: from a manifest to a table, one stage after another (ARCHITECTURE.md). Each step takes what the steps before it
// made and adds to a Build; a step that found errors ends the pass, with everything of that step reported.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/base/files.h"
#include "compiler/base/version.h"
#include "compiler/interfaces/interfaces.h"
#include "compiler/space/scene.h"
#include "compiler/table/table.h"

namespace kiln {

struct BuildOptions {
    std::string manifest;
    std::vector<std::string> scenes;
    std::vector<Target> targets;  // not empty: instead of the manifest's
    bool debug = false;           // -g: in every shader
    bool parse_back = false;
    uint64_t max_states = 100'000;
};

// What the parts of a pass share. The pass owns none of it.
struct PassContext {
    Files& files;
    Store& store;
    Toolchain& tools;
    const Jobs& jobs;
    Progress progress;               // may be empty
    Elsewhere* elsewhere = nullptr;  // may do part of the work on other machines
};

struct BuildWork {
    uint64_t preprocessed = 0;  // files lexed
    uint64_t compiled = 0;      // glslang parses
    uint64_t optimised = 0;
    uint64_t translated = 0;
    uint64_t cache_hits = 0;
    uint64_t store_failures = 0;
};

struct BuildCounts {
    Count declared, legal, needed;
    uint64_t classes = 0, raw = 0, pruned = 0, modules = 0, pipelines = 0;
    std::map<Target, uint64_t> artifacts;
};

struct Build {
    std::optional<Manifest> manifest;
    std::vector<Scene> scenes;
    std::vector<std::unique_ptr<Space>> spaces;  // one per shader of the manifest
    std::vector<std::unique_ptr<Split>> splits;  // one per element of `stages`
    std::vector<StageClasses> stages;            // shader by shader, in stage order; shaders that need nothing are left out
    Modules modules;
    Artifacts artifacts;
    Interfaces interfaces;
    TableFiles files;
    std::string key_header;
    BuildCounts counts;
    BuildWork work;
    std::vector<std::pair<std::string, double>> ms;  // wall time by step, in order
    std::vector<std::string> depends;                // every file that the result depends on, sorted
    Diags diags;
    std::optional<Error> failed;  // an environment's failure or an interrupt, beyond what diags say
    bool ok() const { return !failed && !diags.has_errors(); }
};

// Manifest, scenes, spaces, rules checked. Enough for counts.
void pass_spaces(Build& build, const BuildOptions& options, PassContext& context);
// Classes of every stage: from the store's memo where all that was read still holds, else by preprocessing.
void pass_classes(Build& build, const BuildOptions& options, PassContext& context);
// Modules, artifacts, interfaces, table, proof and key header.
void pass_table(Build& build, const BuildOptions& options, PassContext& context);

// All of it. When the store remembers a whole build whose inputs still hold, only files, key_header, counts, depends, diags
// and work are filled.
Build run_pass(const BuildOptions& options, PassContext& context);

}  // namespace kiln
