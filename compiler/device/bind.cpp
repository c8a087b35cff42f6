#include "compiler/device/bind.h"

#include <algorithm>
#include <deque>
#include <map>

#include "compiler/device/facts.h"

namespace kiln {

namespace {

bool is_buffer(ResourceKind k) { return k == ResourceKind::uniform_block || k == ResourceKind::storage_block; }
bool is_texels(ResourceKind k) { return k == ResourceKind::uniform_texels || k == ResourceKind::storage_texels; }

VkSampler sampler_for(const Samplers& samplers, const Binding& b) {
    if (b.compare) return samplers.compare;
    return b.base == BaseType::float32 ? samplers.smooth : samplers.exact;
}

void make_pool(Context& context, const Inputs& inputs, Bound& out, uint32_t sets) {
    std::map<VkDescriptorType, uint32_t> counts;
    for (const Binding& b : inputs.bindings) counts[descriptor_type(b.kind)] += b.descriptors;
    std::vector<VkDescriptorPoolSize> sizes;
    for (const auto& [type, n] : counts) sizes.push_back({type, n});
    VkDescriptorPoolCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    create.maxSets = sets;
    create.poolSizeCount = static_cast<uint32_t>(sizes.size());
    create.pPoolSizes = sizes.data();
    context.ok(vkCreateDescriptorPool(context.device, &create, nullptr, &out.pool), "vkCreateDescriptorPool");
}

}  // namespace

Samplers make_samplers(Context& context) {
    Samplers out;
    VkSamplerCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    create.magFilter = create.minFilter = VK_FILTER_LINEAR;
    create.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    create.maxLod = VK_LOD_CLAMP_NONE;
    context.ok(vkCreateSampler(context.device, &create, nullptr, &out.smooth), "vkCreateSampler");
    create.addressModeU = create.addressModeV = create.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    create.compareEnable = VK_TRUE;
    create.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
    context.ok(vkCreateSampler(context.device, &create, nullptr, &out.compare), "vkCreateSampler");
    create.compareEnable = VK_FALSE;
    create.magFilter = create.minFilter = VK_FILTER_NEAREST;
    create.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
    context.ok(vkCreateSampler(context.device, &create, nullptr, &out.exact), "vkCreateSampler");
    return out;
}

void destroy(Context& context, Samplers& s) {
    for (const VkSampler sampler : {s.smooth, s.exact, s.compare}) vkDestroySampler(context.device, sampler, nullptr);
    s = {};
}

void bind_inputs(Context& context, Arena& arena, Images& images, const Samplers& samplers, VkCommandBuffer commands,
                 const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, Bound& out) {
    const uint32_t count = static_cast<uint32_t>(pipeline.sets.size());
    if (count == 0) return;
    make_pool(context, inputs, out, count);
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
        for (uint32_t i = 0; i < b.descriptors; ++i) {
            VkWriteDescriptorSet w{};
            w.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
            w.dstSet = out.sets[b.set];
            w.dstBinding = b.binding;
            w.dstArrayElement = i;
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
                w.pImageInfo = &image_infos.emplace_back(
                    VkDescriptorImageInfo{sampler_for(samplers, b), VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED});
            } else {
                const std::shared_ptr<const ImageData>& data = b.images[i];
                Image* image = b.kind == ResourceKind::storage_image
                                   ? images.storage(commands, *data, format_of(b.format, b.base), ordinal++)
                                   : images.sampled(commands, data);
                if (image == nullptr) return;
                written.image = image;
                const VkSampler sampler = b.kind == ResourceKind::combined_image ? sampler_for(samplers, b) : VK_NULL_HANDLE;
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
