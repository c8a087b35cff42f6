// Draws one request: pipeline, then for every set of inputs one submission that uploads, draws and copies back. Buffers,
// images and samplers are reused from request to request; what depends on the pipeline is made and destroyed with it.
// Coverage is told from the depth attachment, which is cleared to a value that no shader is likely to write.

#include "compiler/device/vulkan_device.h"

#include <chrono>
#include <cstring>
#include <map>

#include "compiler/base/digest.h"
#include "compiler/device/bind.h"
#include "compiler/toolchain/spirv.h"

namespace kiln {

namespace {

constexpr float undrawn_depth = 0.123456789f;

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class VulkanDevice final : public Device {
public:
    explicit VulkanDevice(std::unique_ptr<Context> context)
        : context_(std::move(context)), arena_(*context_), images_(*context_, arena_) {
        samplers_ = make_samplers(*context_);
        VkCommandPoolCreateInfo pool{};
        pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
        pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
        pool.queueFamilyIndex = context_->family;
        context_->ok(vkCreateCommandPool(context_->device, &pool, nullptr, &pool_), "vkCreateCommandPool");
        VkCommandBufferAllocateInfo allocate{};
        allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        allocate.commandPool = pool_;
        allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        allocate.commandBufferCount = 1;
        context_->ok(vkAllocateCommandBuffers(context_->device, &allocate, &commands_), "vkAllocateCommandBuffers");
    }
    ~VulkanDevice() override {
        vkDeviceWaitIdle(context_->device);
        vkDestroyCommandPool(context_->device, pool_, nullptr);
        destroy(*context_, samplers_);
    }

    const DeviceInfo& info() const override { return context_->info; }
    bool usable() const { return !context_->failed(); }
    Result<PipelineOutput> run(const PipelineRequest& request) override;

private:
    struct Copy {
        ReadBack back;
        Format format;
        Piece piece;
        bool texels = true;  // unpack by format; else raw words
        bool depth = false;
    };
    bool draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, RunOutput& out);
    void record_draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, const Bound& bound,
                     VkFramebuffer framebuffer, uint32_t attachments);
    bool copy_image(Image& image, Copy& copy);
    VkFramebuffer make_framebuffer(const PipelineRequest& request, const Pipeline& pipeline, const Bound& bound,
                                   std::vector<Copy>& copies, std::vector<Image*>& attachments);
    void record_read(const Bound& bound, std::vector<Copy>& copies);
    const std::string& invalid(const Words& words);

    std::map<Fast, std::string> validated_;
    std::unique_ptr<Context> context_;
    Arena arena_;
    Images images_;
    Samplers samplers_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

bool VulkanDevice::copy_image(Image& image, Copy& copy) {
    copy.format = image.format;
    copy.piece = arena_.take(image.texel_count() * image.format.texel_bytes());
    if (copy.piece.data == nullptr) return false;
    VkBufferImageCopy region{};
    region.bufferOffset = copy.piece.offset;
    region.imageSubresource = {image.aspect, 0, 0, image.layers};
    region.imageExtent = {image.width, image.height, image.slices};
    vkCmdCopyImageToBuffer(commands_, image.image, VK_IMAGE_LAYOUT_GENERAL, copy.piece.buffer, 1, &region);
    return true;
}

VkFramebuffer VulkanDevice::make_framebuffer(const PipelineRequest& request, const Pipeline& pipeline, const Bound& bound,
                                             std::vector<Copy>& copies, std::vector<Image*>& attachments) {
    std::vector<VkImageView> views;
    for (const Output& o : pipeline.outputs) {
        if (o.mask == 0) continue;
        const BaseType base = o.base == BaseType::int32 || o.base == BaseType::uint32 ? o.base : BaseType::float32;
        attachments.push_back(images_.attachment(format_of(0, base), request.size, o.location));
        Copy c;
        c.back.what = "output " + std::to_string(o.location);
        c.back.types = {base};
        copies.push_back(std::move(c));
    }
    attachments.push_back(images_.attachment(depth_format(), request.size, 0));
    Copy depth;
    depth.back.what = "depth";
    depth.back.types = {BaseType::float32};
    depth.back.components = 1;
    depth.depth = true;
    copies.push_back(std::move(depth));
    for (const Image* a : attachments) {
        if (a == nullptr) return VK_NULL_HANDLE;
        views.push_back(a->view);
    }
    views.insert(views.end(), bound.input_views.begin(), bound.input_views.end());
    VkFramebufferCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    create.renderPass = pipeline.pass;
    create.attachmentCount = static_cast<uint32_t>(views.size());
    create.pAttachments = views.data();
    create.width = create.height = request.size;
    create.layers = 1;
    VkFramebuffer out = VK_NULL_HANDLE;
    context_->ok(vkCreateFramebuffer(context_->device, &create, nullptr, &out), "vkCreateFramebuffer");
    return out;
}

void VulkanDevice::record_draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, const Bound& bound,
                               VkFramebuffer framebuffer, uint32_t attachments) {
    const VkPipelineBindPoint point = pipeline.compute ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_GRAPHICS;
    vkCmdBindPipeline(commands_, point, pipeline.pipeline);
    if (!bound.sets.empty())
        vkCmdBindDescriptorSets(commands_, point, pipeline.layout, 0, static_cast<uint32_t>(bound.sets.size()), bound.sets.data(),
                                0, nullptr);
    if (pipeline.push_stages != 0)
        vkCmdPushConstants(commands_, pipeline.layout, pipeline.push_stages, 0,
                           static_cast<uint32_t>(inputs.push_constants.size()), inputs.push_constants.data());
    if (pipeline.compute) {
        vkCmdDispatch(commands_, inputs.groups[0], inputs.groups[1], inputs.groups[2]);
        return;
    }
    for (uint32_t i = 0; i < inputs.attributes.size(); ++i) {
        const Piece piece = arena_.take(inputs.attributes[i].data);
        if (piece.data == nullptr) return;
        vkCmdBindVertexBuffers(commands_, i, 1, &piece.buffer, &piece.offset);
    }
    std::vector<VkClearValue> clears(attachments);
    clears.back().depthStencil = {request.depth_test ? 1.0f : undrawn_depth, 0};
    VkRenderPassBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    begin.renderPass = pipeline.pass;
    begin.framebuffer = framebuffer;
    begin.renderArea = {{0, 0}, {request.size, request.size}};
    begin.clearValueCount = attachments;
    begin.pClearValues = clears.data();
    vkCmdBeginRenderPass(commands_, &begin, VK_SUBPASS_CONTENTS_INLINE);
    if (pipeline.mesh) {
        const auto draw_mesh = reinterpret_cast<PFN_vkCmdDrawMeshTasksEXT>(
            reinterpret_cast<void*>(vkGetDeviceProcAddr(context_->device, "vkCmdDrawMeshTasksEXT")));
        if (draw_mesh != nullptr) draw_mesh(commands_, inputs.groups[0], inputs.groups[1], inputs.groups[2]);
    } else {
        vkCmdDraw(commands_, inputs.vertices, 1, 0, inputs.first_instance);
    }
    vkCmdEndRenderPass(commands_);
}

void VulkanDevice::record_read(const Bound& bound, std::vector<Copy>& copies) {
    for (const Bound::Written& w : bound.written) {
        Copy c;
        const std::string index = w.binding->descriptors > 1 ? "[" + std::to_string(w.element) + "]" : "";
        if (w.image != nullptr) {
            if (w.binding->images[w.element]->multisampled) continue;
            c.back.what = "image " + w.binding->name + index;
            c.back.components = w.image->format.components;
            c.back.types = {w.image->format.base()};
            if (!copy_image(*w.image, c)) return;
        } else {
            c.back.what = "buffer " + w.binding->name + index;
            c.back.components = 1;
            c.texels = w.binding->kind == ResourceKind::storage_texels;
            c.format = format_of(w.binding->format, w.binding->base);
            c.back.types = c.texels ? std::vector<BaseType>{c.format.base()} : w.binding->types;
            c.piece = w.buffer;
        }
        copies.push_back(std::move(c));
    }
}

bool VulkanDevice::draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, RunOutput& out) {
    Context& vk = *context_;
    arena_.reset();
    if (images_.crowded()) images_.clear();
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    if (!vk.ok(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer")) return false;
    Bound bound;
    bind_inputs(vk, arena_, images_, samplers_, commands_, request, pipeline, inputs, bound);
    full_barrier(commands_);

    std::vector<Copy> copies;
    std::vector<Image*> attachments;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    if (!vk.failed() && !pipeline.compute) framebuffer = make_framebuffer(request, pipeline, bound, copies, attachments);
    if (!vk.failed()) record_draw(request, pipeline, inputs, bound, framebuffer, static_cast<uint32_t>(attachments.size()));
    full_barrier(commands_);
    for (size_t i = 0; i < attachments.size() && !vk.failed(); ++i) copy_image(*attachments[i], copies[i]);
    if (!vk.failed()) record_read(bound, copies);
    full_barrier(commands_);
    vk.ok(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");

    // The layer has seen every command by now; what it objects to is not executed.
    if (!vk.failed() && vk.messages.empty()) {
        VkSubmitInfo submit{};
        submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &commands_;
        if (vk.ok(vkQueueSubmit(vk.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit"))
            vk.ok(vkQueueWaitIdle(vk.queue), "vkQueueWaitIdle");
    }
    vkDestroyFramebuffer(vk.device, framebuffer, nullptr);
    const bool good = !vk.failed() && vk.messages.empty();
    for (Copy& c : copies) {
        if (!good || c.piece.data == nullptr) break;
        const ByteView bytes(c.piece.data, static_cast<size_t>(c.piece.size));
        if (c.texels) {
            c.back.words = unpack_texels(c.format, bytes);
        } else {
            c.back.words.resize(bytes.size() / 4);
            std::memcpy(c.back.words.data(), bytes.data(), c.back.words.size() * 4);
        }
        if (c.depth) {
            const float cleared = request.depth_test ? 1.0f : undrawn_depth;
            uint32_t bits;
            std::memcpy(&bits, &cleared, 4);
            for (const uint32_t w : c.back.words) out.covered += w != bits ? 1 : 0;
        }
        out.values.push_back(std::move(c.back));
    }
    if (pipeline.compute) out.covered = uint64_t{inputs.groups[0]} * inputs.groups[1] * inputs.groups[2];
    destroy(vk, bound);
    return good;
}

// What spirv-val has against the words, once for each module; for the Vulkan version that their SPIR-V version came with.
const std::string& VulkanDevice::invalid(const Words& words) {
    const Fast name = xxh3(as_bytes(WordView(words)));
    const auto known = validated_.find(name);
    if (known != validated_.end()) return known->second;
    const uint32_t version = words.size() > 1 ? words[1] : 0;
    Options options;
    options.vulkan = version >= 0x10600 ? 0x103 : version >= 0x10400 ? 0x102 : 0x101;
    std::string why;
    for (const ToolMessage& m : spirv_validate(words, options))
        if (m.severity == Severity::error && why.empty()) why = m.text.empty() ? "invalid" : m.text;
    return validated_[name] = why;
}

Result<PipelineOutput> VulkanDevice::run(const PipelineRequest& request) {
    Context& vk = *context_;
    vk.messages.clear();
    vk.failure.clear();
    PipelineOutput out;
    Pipeline pipeline;
    const double start = now_ms();
    // The layer walks a module's words before it validates them, so what it gets must be valid already.
    for (const StageCode& s : request.stages)
        if (const std::string why = invalid(s.words); !why.empty()) {
            out.errors.push_back(std::string("spirv-val, ") + name_of(s.stage) + " stage: " + why);
            return out;
        }
    make_pipeline(vk, request, pipeline, out.unsupported);
    out.create_ms = now_ms() - start;
    if (out.unsupported.empty() && !vk.failed() && vk.messages.empty())
        for (const Inputs& inputs : request.inputs) {
            RunOutput run;
            if (!draw(request, pipeline, inputs, run)) break;
            out.runs.push_back(std::move(run));
        }
    destroy(vk, pipeline);
    out.run_ms = now_ms() - start - out.create_ms;
    // A capability or extension that the device lacks is the device's limit, not the module's fault. So is a driver whose own
    // parser gives up on words that spirv-val accepted: Mesa 22.3 does on OpCopyLogical.
    bool all_missing = !vk.messages.empty();
    for (const LayerMessage& m : vk.messages) {
        all_missing &= m.id == "VUID-VkShaderModuleCreateInfo-pCode-01091" ||
                       m.id == "VUID-VkShaderModuleCreateInfo-pCode-04147" ||
                       m.text.find("SPIR-V parsing FAILED") != std::string::npos;
        out.errors.push_back(m.text);
    }
    if (all_missing) {
        out.unsupported = out.errors.front();
        out.errors.clear();
    }
    if (vk.failed() && out.unsupported.empty()) out.errors.push_back(vk.failure);
    if (vk.failure.find("VkResult -4") != std::string::npos) return environment_error("the Vulkan device is lost: " + vk.failure);
    return out;
}

}  // namespace

Result<std::unique_ptr<Device>> open_vulkan_device(const DriverChoice& choice) {
    Result<std::string> icd = find_driver(choice);
    KILN_TRY(icd);
    apply_driver(*icd, choice);
    Result<std::unique_ptr<Context>> context = Context::open();
    KILN_TRY(context);
    (*context)->info.settings = driver_settings();
    auto device = std::make_unique<VulkanDevice>(std::move(*context));
    if (!device->usable()) return environment_error("the Vulkan device refuses our own set-up");
    return std::unique_ptr<Device>(std::move(device));
}

}  // namespace kiln
