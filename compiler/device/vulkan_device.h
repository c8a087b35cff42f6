#pragma once
// The real Device: Vulkan with the validation layer on.

#include <memory>

#include "compiler/device/driver.h"
#include "compiler/validate/device.h"

namespace kiln {

// Sets the process's environment (driver.h) and opens the driver's first device. Environment errors say what is missing.
Result<std::unique_ptr<Device>> open_vulkan_device(const DriverChoice& choice);

}  // namespace kiln
