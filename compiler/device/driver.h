#pragma once
// Which Vulkan driver runs, chosen by hand: the loader's own order depends on what else the machine has installed.

#include <string>
#include <vector>

#include "compiler/base/result.h"

namespace kiln {

struct DriverChoice {
    std::string icd;        // path of an ICD manifest (.json); empty: $KILN_ICD, else lavapipe where the loader would look
    std::string cache_dir;  // Mesa's disk cache; empty: Mesa's own default
};

// The ICD manifest that `choice` names. An environment error when there is none, saying which package brings lavapipe.
Result<std::string> find_driver(const DriverChoice& choice);

// Sets the environment that the loader and Mesa read: this driver alone; exact texture filtering and no LLVM optimisation
// passes (GALLIVM_PERF=no_aos_sampling,nopt: same results, half the time), no rasteriser threads. Call before the first
// Vulkan call and before threads start. Variables that the user has set stay, but for the choice of driver.
void apply_driver(const std::string& icd, const DriverChoice& choice);

// The variables of those that decide results, as they are now.
std::string driver_settings();

}  // namespace kiln
