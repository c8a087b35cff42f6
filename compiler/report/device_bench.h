#pragma once
// The report's bench on a Vulkan device: one device with the validation layer for the pictures, one without for the clock.

#include "compiler/device/driver.h"
#include "compiler/report/bench.h"

namespace kiln::report {

// `tools` and `library` outlive the bench.
Result<std::unique_ptr<Bench>> open_device_bench(const DriverChoice& choice, Toolchain& tools, Library& library);

}  // namespace kiln::report
