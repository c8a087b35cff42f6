#pragma once
// Classes to modules: compile each class once, prune, merge equal ones, optimise, merge again (DESIGN section 4).

#include <functional>
#include <vector>

#include "compiler/base/jobs.h"
#include "compiler/base/store.h"
#include "compiler/split.h"
#include "compiler/toolchain.h"

namespace kiln {

// One stage of one shader, ready to compile.
struct StageClasses {
    const Shader* shader = nullptr;
    Space* space = nullptr;
    Stage stage = Stage::vertex;
    const Split* split = nullptr;
};

struct Module {
    Stage stage = Stage::vertex;
    Words words;        // optimised
    Words unoptimised;  // one pruned representative, for the proof
    Digest digest;      // of words
    Reflection reflection;
};

struct Modules {
    std::vector<Module> list;                     // distinct, in order of first use
    std::vector<std::vector<uint32_t>> of_class;  // [stage index][class index] -> module
    Diags diags;
    uint64_t raw = 0, pruned = 0;  // distinct counts
    uint64_t compiled = 0, optimised = 0, cache_hits = 0;
};

using Progress = std::function<void(const char* what, size_t done, size_t total)>;

Modules build_modules(const std::vector<StageClasses>& stages, Store& store, Toolchain& tools, const Jobs& jobs,
                      const Progress& progress);

}  // namespace kiln
