#pragma once
// Which Vulkan driver runs, chosen by hand: the loader's own order depends on what else the machine has installed.

#include <string>
#include <vector>

#include "compiler/base/result.h"

namespace kiln {

struct DriverChoice {
    std::string icd;        // path of an ICD manifest (.json); empty: $KILN_ICD, else lavapipe where the loader would look
    std::string cache_dir;  // Mesa's disk cache; empty: Mesa's own default
    // For measuring. LLVM's optimisation passes are on or off for the whole process, by the first device that it opens.
    bool optimise = false;
    bool shader_cache =
        true;           // false: nothing is read from or written to Mesa's disk cache, so that compiling costs its full time
    bool layer = true;  // the validation layer, which costs time in every call; off for measuring only
};

// The ICD manifest that `choice` names. An environment error when there is none, saying which package brings lavapipe.
Result<std::string> find_driver(const DriverChoice& choice);

// Sets the environment that the loader and Mesa read: this driver alone; exact texture filtering and, unless
// choice.optimise, no LLVM optimisation passes (GALLIVM_PERF=no_aos_sampling,nopt: same results, half the time to compile); no
// rasteriser threads. Call before the first Vulkan call and before threads start. Variables that the user has set stay, but for
// the choice of driver and the disk cache. An environment error when choice.optimise meets a GALLIVM_PERF that says nopt.
Status apply_driver(const std::string& icd, const DriverChoice& choice);

// The variables of those that decide results or times, as they are now.
std::string driver_settings();

}  // namespace kiln
