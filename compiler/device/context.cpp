#include "compiler/device/context.h"

#include <algorithm>
#include <cstring>

namespace kiln {

namespace {

constexpr const char* layer_name = "VK_LAYER_KHRONOS_validation";
constexpr size_t message_limit = 16;
constexpr size_t message_bytes = 1200;

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    Context& context = *static_cast<Context*>(user);
    if ((severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) == 0 || context.messages.size() >= message_limit)
        return VK_FALSE;
    LayerMessage m;
    if (data->pMessageIdName != nullptr) m.id = data->pMessageIdName;
    if (data->pMessage != nullptr) m.text = std::string(data->pMessage).substr(0, message_bytes);
    context.messages.push_back(std::move(m));
    return VK_FALSE;
}

std::string version_text(uint32_t v) {
    return std::to_string(VK_API_VERSION_MAJOR(v)) + "." + std::to_string(VK_API_VERSION_MINOR(v)) + "." +
           std::to_string(VK_API_VERSION_PATCH(v));
}

std::vector<std::string> device_extensions(VkPhysicalDevice physical) {
    uint32_t n = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &n, nullptr);
    std::vector<VkExtensionProperties> list(n);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &n, list.data());
    std::vector<std::string> out;
    for (const VkExtensionProperties& e : list) out.emplace_back(e.extensionName);
    return out;
}

}  // namespace

bool Context::ok(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return true;
    if (failure.empty()) failure = std::string(call) + " failed with VkResult " + std::to_string(static_cast<int>(result));
    return false;
}

uint32_t Context::memory_type(uint32_t bits, VkMemoryPropertyFlags wanted) const {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
        if ((bits >> i & 1) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    return ~0u;
}

Result<std::unique_ptr<Context>> Context::open(bool layer) {
    auto context = std::make_unique<Context>();
    KILN_TRY(context->open_instance(layer));
    KILN_TRY(context->open_device());
    return context;
}

Status Context::open_instance(bool layer) {
    if (layer) {
        uint32_t n = 0;
        vkEnumerateInstanceLayerProperties(&n, nullptr);
        std::vector<VkLayerProperties> layers(n);
        vkEnumerateInstanceLayerProperties(&n, layers.data());
        const auto found = std::find_if(layers.begin(), layers.end(),
                                        [](const VkLayerProperties& l) { return std::strcmp(l.layerName, layer_name) == 0; });
        if (found == layers.end())
            return environment_error(std::string(layer_name) +
                                     " is not installed, and nothing is validated without it; install the package "
                                     "vulkan-validationlayers");
        info.layers = std::string(layer_name) + " " + version_text(found->specVersion) + " (implementation " +
                      std::to_string(found->implementationVersion) + ")";
    } else {
        info.layers = "none";
    }

    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.pApplicationName = "kiln";
    application.apiVersion = VK_API_VERSION_1_3;
    VkDebugUtilsMessengerCreateInfoEXT listen{};
    listen.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    listen.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    listen.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
    listen.pfnUserCallback = on_message;
    listen.pUserData = this;
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkInstanceCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    create.pApplicationInfo = &application;
    if (layer) {
        create.enabledLayerCount = create.enabledExtensionCount = 1;
        create.ppEnabledLayerNames = &layer_name;
        create.ppEnabledExtensionNames = &extension;
    }
    if (!ok(vkCreateInstance(&create, nullptr, &instance), "vkCreateInstance")) {
        instance = VK_NULL_HANDLE;
        return environment_error(failure + ": no usable Vulkan driver");
    }
    if (!layer) return {};
    const auto make = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        reinterpret_cast<void*>(vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT")));
    if (make == nullptr || !ok(make(instance, &listen, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT"))
        return environment_error("the Vulkan loader offers no debug messenger");
    return {};
}

Status Context::open_device() {
    uint32_t n = 0;
    vkEnumeratePhysicalDevices(instance, &n, nullptr);
    if (n == 0) return environment_error("the Vulkan driver offers no device");
    std::vector<VkPhysicalDevice> all(n);
    vkEnumeratePhysicalDevices(instance, &n, all.data());
    physical = all[0];
    vkGetPhysicalDeviceMemoryProperties(physical, &memory);

    VkPhysicalDeviceDriverProperties driver{};
    driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
    VkPhysicalDeviceProperties2 properties2{};
    properties2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    vkGetPhysicalDeviceProperties(physical, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_2)
        return environment_error("the device '" + std::string(properties.deviceName) + "' has Vulkan " +
                                 version_text(properties.apiVersion) + "; at least 1.2 is needed");
    properties2.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &properties2);
    info.name = properties.deviceName;
    info.driver = std::string(driver.driverName) + " " + driver.driverInfo + ", Vulkan " + version_text(properties.apiVersion);

    uint32_t families = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, nullptr);
    std::vector<VkQueueFamilyProperties> kinds(families);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, kinds.data());
    const VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while (family < families && (kinds[family].queueFlags & both) != both) ++family;
    if (family == families) return environment_error("the device '" + info.name + "' has no queue for graphics and compute");

    timestamp_bits = kinds[family].timestampValidBits;

    // Every feature that the device has is switched on, so that a module is refused only where the device cannot run it.
    const std::vector<std::string> have = device_extensions(physical);
    const auto has = [&](const char* name) { return std::find(have.begin(), have.end(), name) != have.end(); };
    VkPhysicalDeviceVulkan11Features f11{};
    VkPhysicalDeviceVulkan12Features f12{};
    VkPhysicalDeviceVulkan13Features f13{};
    VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomics{};
    VkPhysicalDeviceShaderClockFeaturesKHR clock{};
    VkPhysicalDeviceMeshShaderFeaturesEXT mesh{};
    f11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
    f12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    f13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    atomics.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT;
    clock.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CLOCK_FEATURES_KHR;
    mesh.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT;
    std::vector<const char*> extensions;
    VkPhysicalDeviceFeatures2 features2{};
    features2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    void** tail = &features2.pNext;
    const auto chain = [&](auto& feature, const char* extension) {
        if (extension != nullptr) {
            if (!has(extension)) return;
            extensions.push_back(extension);
        }
        *tail = &feature;
        tail = &feature.pNext;
    };
    chain(f11, nullptr);
    chain(f12, nullptr);
    if (properties.apiVersion >= VK_API_VERSION_1_3) chain(f13, nullptr);
    chain(atomics, VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME);
    chain(clock, VK_KHR_SHADER_CLOCK_EXTENSION_NAME);
    chain(mesh, VK_EXT_MESH_SHADER_EXTENSION_NAME);
    for (const char* plain : {VK_EXT_SHADER_STENCIL_EXPORT_EXTENSION_NAME, VK_EXT_SHADER_VIEWPORT_INDEX_LAYER_EXTENSION_NAME})
        if (has(plain)) extensions.push_back(plain);
    vkGetPhysicalDeviceFeatures2(physical, &features2);
    mesh.multiviewMeshShader = VK_FALSE;  // these two ask for features that we do not chain
    mesh.primitiveFragmentShadingRateMeshShader = VK_FALSE;
    mesh_shaders = mesh.meshShader == VK_TRUE;
    features = features2.features;

    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queues{};
    queues.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queues.queueFamilyIndex = family;
    queues.queueCount = 1;
    queues.pQueuePriorities = &priority;
    VkDeviceCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    create.pNext = &features2;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queues;
    create.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    create.ppEnabledExtensionNames = extensions.data();
    if (!ok(vkCreateDevice(physical, &create, nullptr, &device), "vkCreateDevice")) {
        device = VK_NULL_HANDLE;
        return environment_error(failure + " on '" + info.name + "'");
    }
    vkGetDeviceQueue(device, family, 0, &queue);
    if (!messages.empty()) return environment_error("the validation layer refuses our own set-up: " + messages.front().text);
    return {};
}

Context::~Context() {
    if (device != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device);
        vkDestroyDevice(device, nullptr);
    }
    if (instance == VK_NULL_HANDLE) return;
    const auto drop = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        reinterpret_cast<void*>(vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT")));
    if (drop != nullptr && messenger_ != VK_NULL_HANDLE) drop(instance, messenger_, nullptr);
    vkDestroyInstance(instance, nullptr);
}

}  // namespace kiln
