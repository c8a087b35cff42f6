#include "compiler/device/vulkan_device.h"
#include "tests/device/glsl.h"

namespace kiln::test {

Device& device() {
    static Result<std::unique_ptr<Device>> opened = open_vulkan_device({});
    if (!opened.ok()) {
        ADD_FAILURE() << opened.error().message;
        std::abort();
    }
    return **opened;
}

}  // namespace kiln::test
