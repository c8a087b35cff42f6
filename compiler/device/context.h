#pragma once
// One Vulkan instance, device and queue, with the validation layer on unless told otherwise, and what the layer said since it was
// last asked.
// Internal to compiler/device.

#include <vulkan/vulkan.h>

#include <memory>
#include <string>
#include <vector>

#include "compiler/validate/device.h"

namespace kiln {

struct LayerMessage {
    std::string id;  // "VUID-…"
    std::string text;
};

class Context {
public:
    // The first device of the driver that apply_driver() chose. Where the layer is asked for and not installed, an error.
    static Result<std::unique_ptr<Context>> open(bool layer);
    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context();

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t family = 0;
    uint32_t timestamp_bits = 0;  // of the queue; 0: it has no timestamps
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    VkPhysicalDeviceFeatures features{};  // all that the device has are on
    bool mesh_shaders = false;
    DeviceInfo info;

    // True for VK_SUCCESS; else remembers the first failed call.
    bool ok(VkResult result, const char* call);
    bool failed() const { return !failure.empty(); }
    std::string failure;
    std::string lacking;                 // what this device cannot do, found while images were made
    std::vector<LayerMessage> messages;  // severity error, at most a few, since last cleared

    // Index of a memory type among `bits` with all `wanted` properties; ~0u when there is none.
    uint32_t memory_type(uint32_t bits, VkMemoryPropertyFlags wanted) const;

private:
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    Status open_instance(bool layer);
    Status open_device();
};

}  // namespace kiln
