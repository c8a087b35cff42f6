#pragma once
// Descriptor sets for one set of inputs, bound by the published (set, binding). Internal to compiler/device.

#include "compiler/device/pipeline.h"

namespace kiln {

// Samplers that live as long as the device, made when first asked for.
class Samplers {
public:
    explicit Samplers(Context& context) : context_(context) {}
    Samplers(const Samplers&) = delete;
    Samplers& operator=(const Samplers&) = delete;
    ~Samplers();
    VkSampler get(const SamplerState& state, bool integer);  // null: context.failure says why

private:
    Context& context_;
    std::map<std::pair<SamplerState, bool>, VkSampler> made_;
};

// What was bound, for reading back and for clean-up.
struct Bound {
    struct Written {
        const Binding* binding = nullptr;
        uint32_t element = 0;
        Piece buffer;            // storage blocks and texel buffers
        Image* image = nullptr;  // storage images
    };
    std::vector<VkDescriptorSet> sets;
    std::vector<Written> written;
    std::vector<VkImageView> input_views;  // input attachments, in order of Pipeline::inputs
    VkDescriptorPool pool = VK_NULL_HANDLE;
    std::vector<VkBufferView> views;
};

// Records uploads into `commands`. Stops at the first failure (context.failure).
void bind_inputs(Context& context, Arena& arena, Images& images, Samplers& samplers, VkCommandBuffer commands,
                 const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, Bound& out);
void destroy(Context& context, Bound& bound);

}  // namespace kiln
