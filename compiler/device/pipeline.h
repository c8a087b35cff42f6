#pragma once
// A Vulkan pipeline, its layout and its render pass for one request. Internal to compiler/device.

#include <map>

#include "compiler/device/memory.h"

namespace kiln {

// One colour attachment: a location that the fragment stage writes.
struct Output {
    uint32_t location = 0;
    BaseType base = BaseType::float32;
    uint32_t mask = 0;  // components written
};

struct InputImage {
    uint32_t index = 0;
    Format format;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;  // those of Images::make
};

struct Pipeline {
    std::vector<VkDescriptorSetLayout> sets;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> spare;  // by (set, binding): descriptors that no shader has (spare.h)
    VkShaderStageFlags push_stages = 0;
    VkRenderPass pass = VK_NULL_HANDLE;       // clears its attachments
    VkRenderPass load_pass = VK_NULL_HANDLE;  // keeps what they hold; only after make_load_pass()
    std::vector<VkShaderModule> modules;
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::vector<Output> outputs;     // by location; a gap is an output with mask 0
    std::vector<InputImage> inputs;  // input attachments by index
    bool compute = false, mesh = false;
};

// The pipeline objects, made in the order modules, layout, pass, pipeline; stops at the first that the layer or the driver
// refuses, which context.messages and context.failure then tell. `unsupported` is set where the device cannot run such stages.
void make_pipeline(Context& context, const PipelineRequest& request, Pipeline& out, std::string& unsupported);
// A pass that the pipeline can be drawn in as well.
void make_load_pass(Context& context, Pipeline& pipeline);
void destroy(Context& context, Pipeline& pipeline);

VkDescriptorType descriptor_type(ResourceKind kind);
VkShaderStageFlagBits stage_bit(Stage stage);

}  // namespace kiln
