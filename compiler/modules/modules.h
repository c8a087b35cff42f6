#pragma once
// Classes to modules: compile each class once, prune, merge equal ones, optimise, merge again (ARCHITECTURE.md).

#include <functional>
#include <vector>

#include "compiler/base/jobs.h"
#include "compiler/base/store.h"
#include "compiler/modules/elsewhere.h"
#include "compiler/split/split.h"
#include "compiler/toolchain/toolchain.h"

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
    uint64_t raw = 0, pruned = 0;                          // distinct counts
    uint64_t compiled = 0, optimised = 0, cache_hits = 0;  // parses; modules; classes found in the store
    uint64_t store_failures = 0;                           // gets and puts that failed; the first one is a warning
};

using Progress = std::function<void(const char* what, size_t done, size_t total)>;

// Line `line` (from 1) of a file that Split::files names, for the caret under an error; empty when it cannot be had.
using SourceLines = std::function<std::string(const std::string& file, uint32_t line)>;

// Every class is compiled before any error is reported; after an error nothing is optimised and `list` is empty. Warnings are
// kept in the store's records and shown again on a hit. A store that fails costs time and a warning, never the build. The result
// depends on the classes, the options and the tools alone: neither on threads nor on what the store holds.
Modules build_modules(const std::vector<StageClasses>& stages, Store& store, Toolchain& tools, const Jobs& jobs,
                      const Progress& progress, const SourceLines& lines = {}, Elsewhere* elsewhere = nullptr);

}  // namespace kiln
