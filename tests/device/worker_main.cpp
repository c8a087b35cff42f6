// The worker process of these tests.

#include "compiler/device/vulkan_device.h"
#include "compiler/validate/workers.h"

int main() {
    return kiln::run_worker([] { return kiln::open_vulkan_device({}); });
}
