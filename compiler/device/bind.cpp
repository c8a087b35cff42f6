#include "compiler/device/bind.h"

#include <algorithm>
#include <deque>
#include <map>

#include "compiler/device/facts.h"

namespace kiln {

namespace {

bool is_buffer(ResourceKind k) { return k == ResourceKind::uniform_block || k == ResourceKind::storage_block; }
bool is_texels(ResourceKind k) { return k == ResourceKind::uniform_texels || k == ResourceKind::storage_texels; }

SamplerState usual_state(const Binding& b) {
    if (b.compare) return {Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::less_or_equal};
    if (b.base == BaseType::float32) return {};
    return {Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off};
}

VkSampler sampler_for(Context& context, Samplers& samplers, const Binding& b) {
    const SamplerState state = b.sampler.value_or(usual_state(b));
    if ((state.compare != Comparison::off) != b.compare) {
        context.failure = "the shader " + std::string(b.compare ? "compares" : "does not compare") + " through '" + b.name +
                          "', and the sampler given for it " + (b.compare ? "does not" : "does");
        return VK_NULL_HANDLE;
    }
    return samplers.get(state, b.base != BaseType::float32);
}

VkSamplerAddressMode address_mode(Wrap wrap) {
    switch (wrap) {
        case Wrap::mirror:
            return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case Wrap::clamp:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        case Wrap::border_black:
        case Wrap::border_white:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
        default:
            return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    }
}

VkBorderColor border_colour(Wrap wrap, bool integer) {
    if (wrap == Wrap::border_white) return integer ? VK_BORDER_COLOR_INT_OPAQUE_WHITE : VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE;
    return integer ? VK_BORDER_COLOR_INT_OPAQUE_BLACK : VK_BORDER_COLOR_FLOAT_OPAQUE_BLACK;
}

VkCompareOp compare_op(Comparison compare) {
    switch (compare) {
        case Comparison::less:
            return VK_COMPARE_OP_LESS;
        case Comparison::greater_or_equal:
            return VK_COMPARE_OP_GREATER_OR_EQUAL;
        case Comparison::greater:
            return VK_COMPARE_OP_GREATER;
        default:
            return VK_COMPARE_OP_LESS_OR_EQUAL;
    }
}

// With those that no shader has.
uint32_t descriptors_of(const Pipeline& pipeline, const Binding& b) {
    const auto spare = pipeline.spare.find({b.set, b.binding});
    return b.descriptors + (spare == pipeline.spare.end() ? 0 : spare->second);
}

void make_pool(Context& context, const Inputs& inputs, const Pipeline& pipeline, Bound& out) {
    std::map<VkDescriptorType, uint32_t> counts;
    for (const Binding& b : inputs.bindings) counts[descriptor_type(b.kind)] += descriptors_of(pipeline, b);
    std::vector<VkDescriptorPoolSize> sizes;
    for (const auto& [type, n] : counts) sizes.push_back({type, n});
    VkDescriptorPoolCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    create.maxSets = static_cast<uint32_t>(pipeline.sets.size());
    create.poolSizeCount = static_cast<uint32_t>(sizes.size());
    create.pPoolSizes = sizes.data();
    context.ok(vkCreateDescriptorPool(context.device, &create, nullptr, &out.pool), "vkCreateDescriptorPool");
}

}  // namespace

VkSampler Samplers::get(const SamplerState& state, bool integer) {
    const auto known = made_.find({state, integer});
    if (known != made_.end()) return known->second;
    VkSamplerCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    create.magFilter = create.minFilter = state.filter == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
    create.mipmapMode = state.mips == MipFilter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
    create.maxLod = state.mips == MipFilter::none ? 0.0f : VK_LOD_CLAMP_NONE;
    create.addressModeU = create.addressModeV = create.addressModeW = address_mode(state.wrap);
    create.borderColor = border_colour(state.wrap, integer);
    create.compareEnable = state.compare != Comparison::off ? VK_TRUE : VK_FALSE;
    create.compareOp = compare_op(state.compare);
    VkSampler sampler = VK_NULL_HANDLE;
    if (!context_.ok(vkCreateSampler(context_.device, &create, nullptr, &sampler), "vkCreateSampler")) return VK_NULL_HANDLE;
    return made_[{state, integer}] = sampler;
}

Samplers::~Samplers() {
    for (const auto& [state, sampler] : made_) vkDestroySampler(context_.device, sampler, nullptr);
}

void bind_inputs(Context& context, Arena& arena, Images& images, Samplers& samplers, VkCommandBuffer commands,
                 const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, Bound& out) {
    const uint32_t count = static_cast<uint32_t>(pipeline.sets.size());
    if (count == 0) return;
    make_pool(context, inputs, pipeline, out);
    if (context.failed()) return;
    VkDescriptorSetAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    allocate.descriptorPool = out.pool;
    allocate.descriptorSetCount = count;
    allocate.pSetLayouts = pipeline.sets.data();
    out.sets.resize(count);
    if (!context.ok(vkAllocateDescriptorSets(context.device, &allocate, out.sets.data()), "vkAllocateDescriptorSets")) return;

    std::deque<VkDescriptorBufferInfo> buffers;  // deques: the writes below point into them
    std::deque<VkDescriptorImageInfo> image_infos;
    std::vector<VkWriteDescriptorSet> writes;
    std::map<uint32_t, VkImageView> input_views;
    uint32_t ordinal = 0;
    for (const Binding& b : inputs.bindings)
        for (uint32_t place = 0; place < descriptors_of(pipeline, b); ++place) {
            const uint32_t i = std::min(place, b.descriptors - 1);
            VkWriteDescriptorSet w{};
            w.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
            w.dstSet = out.sets[b.set];
            w.dstBinding = b.binding;
            w.dstArrayElement = place;
            w.descriptorCount = 1;
            w.descriptorType = descriptor_type(b.kind);
            Bound::Written written{&b, i, {}, nullptr};
            if (is_buffer(b.kind) || is_texels(b.kind)) {
                const Format format = format_of(b.format, b.base);
                written.buffer = arena.take(is_texels(b.kind) ? pack_texels(format, b.buffers[i]) : b.buffers[i]);
                if (written.buffer.data == nullptr) return;
                if (is_texels(b.kind)) {
                    VkBufferViewCreateInfo create{};
                    create.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
                    create.buffer = written.buffer.buffer;
                    create.format = format.vk;
                    create.offset = written.buffer.offset;
                    create.range = written.buffer.size;
                    VkBufferView view = VK_NULL_HANDLE;
                    if (!context.ok(vkCreateBufferView(context.device, &create, nullptr, &view), "vkCreateBufferView")) return;
                    out.views.push_back(view);
                } else {
                    w.pBufferInfo = &buffers.emplace_back(
                        VkDescriptorBufferInfo{written.buffer.buffer, written.buffer.offset, written.buffer.size});
                }
            } else if (b.kind == ResourceKind::separate_sampler) {
                const VkSampler sampler = sampler_for(context, samplers, b);
                if (sampler == VK_NULL_HANDLE) return;
                w.pImageInfo =
                    &image_infos.emplace_back(VkDescriptorImageInfo{sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED});
            } else {
                const std::shared_ptr<const ImageData>& data = b.images[i];
                Image* image = b.kind == ResourceKind::storage_image
                                   ? images.storage(commands, *data, format_of(b.format, b.base), ordinal++)
                                   : images.sampled(commands, data);
                if (image == nullptr) return;
                written.image = image;
                const bool combined = b.kind == ResourceKind::combined_image;
                const VkSampler sampler = combined ? sampler_for(context, samplers, b) : VK_NULL_HANDLE;
                if (combined && sampler == VK_NULL_HANDLE) return;
                w.pImageInfo = &image_infos.emplace_back(VkDescriptorImageInfo{sampler, image->view, VK_IMAGE_LAYOUT_GENERAL});
                if (b.kind == ResourceKind::input_attachment)
                    for (const StageCode& s : request.stages) {
                        const auto index = facts_of(s.words).input_attachment_index;
                        if (const auto at = index.find({b.set, b.binding}); at != index.end())
                            input_views[at->second] = image->view;
                    }
            }
            if (b.written) out.written.push_back(written);
            writes.push_back(w);
        }
    size_t view = 0;
    for (VkWriteDescriptorSet& w : writes)
        if (w.descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER ||
            w.descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER)
            w.pTexelBufferView = &out.views[view++];
    vkUpdateDescriptorSets(context.device, static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
    for (const InputImage& i : pipeline.inputs) out.input_views.push_back(input_views[i.index]);
}

void destroy(Context& context, Bound& b) {
    for (const VkBufferView v : b.views) vkDestroyBufferView(context.device, v, nullptr);
    vkDestroyDescriptorPool(context.device, b.pool, nullptr);
    b = {};
}

}  // namespace kiln
