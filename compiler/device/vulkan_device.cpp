// Draws one request: pipeline, then for every set of inputs one submission that uploads, draws and copies back. Buffers,
// images and samplers are reused from request to request; what depends on the pipeline is made and destroyed with it.
// Coverage is told from the depth attachment, which is cleared to a value that no shader is likely to write.

#include "compiler/device/vulkan_device.h"

#include <chrono>
#include <cstring>

#include "compiler/device/vulkan_run.h"
#include "compiler/toolchain/spirv.h"

namespace kiln {

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

float cleared_depth(const PipelineRequest& request) { return request.depth_test ? 1.0f : 0.123456789f; }

VulkanDevice::VulkanDevice(std::unique_ptr<Context> context)
    : context_(std::move(context)), arena_(*context_), images_(*context_, arena_), samplers_(*context_) {
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

VulkanDevice::~VulkanDevice() {
    vkDeviceWaitIdle(context_->device);
    vkDestroyCommandPool(context_->device, pool_, nullptr);
}

bool VulkanDevice::begin(VkCommandBufferUsageFlags flags) {
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = flags;
    return context_->ok(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
}

void VulkanDevice::bind(Frame& frame) {
    arena_.reset();
    if (images_.crowded()) images_.clear();
    bind_inputs(*context_, arena_, images_, samplers_, commands_, frame.request, frame.pipeline, frame.inputs, frame.bound);
    for (const Attribute& a : frame.inputs.attributes) {
        frame.vertices.push_back(arena_.take(a.data));
        if (frame.vertices.back().data == nullptr) break;
    }
    if (!context_->failed() && context_->lacking.empty() && !frame.pipeline.compute) make_framebuffer(frame);
    full_barrier(commands_);
}

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

void VulkanDevice::make_framebuffer(Frame& frame) {
    const uint32_t width = frame.request.size, height = frame.request.rows();
    for (const Output& o : frame.pipeline.outputs) {
        if (o.mask == 0) continue;
        const BaseType base = o.base == BaseType::int32 || o.base == BaseType::uint32 ? o.base : BaseType::float32;
        frame.attachments.push_back(images_.attachment(format_of(0, base), width, height, o.location));
        Copy c;
        c.back.what = "output " + std::to_string(o.location);
        c.back.types = {base};
        frame.copies.push_back(std::move(c));
    }
    frame.attachments.push_back(images_.attachment(depth_format(), width, height, 0));
    Copy depth;
    depth.back.what = "depth";
    depth.back.types = {BaseType::float32};
    depth.back.components = 1;
    depth.depth = true;
    frame.copies.push_back(std::move(depth));
    std::vector<VkImageView> views;
    for (const Image* a : frame.attachments) {
        if (a == nullptr) return;
        views.push_back(a->view);
    }
    views.insert(views.end(), frame.bound.input_views.begin(), frame.bound.input_views.end());
    VkFramebufferCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    create.renderPass = frame.pipeline.pass;
    create.attachmentCount = static_cast<uint32_t>(views.size());
    create.pAttachments = views.data();
    create.width = width;
    create.height = height;
    create.layers = 1;
    context_->ok(vkCreateFramebuffer(context_->device, &create, nullptr, &frame.framebuffer), "vkCreateFramebuffer");
}

void VulkanDevice::record_state(const Frame& frame) {
    const Pipeline& pipeline = frame.pipeline;
    const std::vector<VkDescriptorSet>& sets = frame.bound.sets;
    const VkPipelineBindPoint point = pipeline.compute ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_GRAPHICS;
    vkCmdBindPipeline(commands_, point, pipeline.pipeline);
    if (!sets.empty())
        vkCmdBindDescriptorSets(commands_, point, pipeline.layout, 0, static_cast<uint32_t>(sets.size()), sets.data(), 0,
                                nullptr);
    if (pipeline.push_stages != 0)
        vkCmdPushConstants(commands_, pipeline.layout, pipeline.push_stages, 0,
                           static_cast<uint32_t>(frame.inputs.push_constants.size()), frame.inputs.push_constants.data());
    if (pipeline.compute) return;
    for (uint32_t i = 0; i < frame.vertices.size(); ++i)
        vkCmdBindVertexBuffers(commands_, i, 1, &frame.vertices[i].buffer, &frame.vertices[i].offset);
}

void VulkanDevice::record_draw(const Frame& frame, VkRenderPass pass) {
    const std::array<uint32_t, 3>& groups = frame.inputs.groups;
    if (frame.pipeline.compute) {
        vkCmdDispatch(commands_, groups[0], groups[1], groups[2]);
        return;
    }
    std::vector<VkClearValue> clears(frame.attachments.size());
    clears.back().depthStencil = {cleared_depth(frame.request), 0};
    VkRenderPassBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    begin.renderPass = pass;
    begin.framebuffer = frame.framebuffer;
    begin.renderArea = {{0, 0}, {frame.request.size, frame.request.rows()}};
    begin.clearValueCount = static_cast<uint32_t>(clears.size());
    begin.pClearValues = clears.data();
    vkCmdBeginRenderPass(commands_, &begin, VK_SUBPASS_CONTENTS_INLINE);
    if (frame.pipeline.mesh) {
        const auto draw_mesh = reinterpret_cast<PFN_vkCmdDrawMeshTasksEXT>(
            reinterpret_cast<void*>(vkGetDeviceProcAddr(context_->device, "vkCmdDrawMeshTasksEXT")));
        if (draw_mesh != nullptr) draw_mesh(commands_, groups[0], groups[1], groups[2]);
    } else {
        vkCmdDraw(commands_, frame.inputs.vertices, 1, 0, frame.inputs.first_instance);
    }
    vkCmdEndRenderPass(commands_);
}

void VulkanDevice::record_read(Frame& frame) {
    for (size_t i = 0; i < frame.attachments.size(); ++i)
        if (!copy_image(*frame.attachments[i], frame.copies[i])) return;
    for (const Bound::Written& w : frame.bound.written) {
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
        frame.copies.push_back(std::move(c));
    }
}

bool VulkanDevice::end_and_submit() {
    Context& vk = *context_;
    vk.ok(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
    // The layer has seen every command by now; what it objects to is not executed.
    if (vk.failed() || !vk.messages.empty() || !vk.lacking.empty()) return false;
    VkSubmitInfo submit{};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands_;
    if (vk.ok(vkQueueSubmit(vk.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit"))
        vk.ok(vkQueueWaitIdle(vk.queue), "vkQueueWaitIdle");
    return !vk.failed() && vk.messages.empty();
}

RunOutput VulkanDevice::take_output(Frame& frame) {
    RunOutput out;
    for (Copy& c : frame.copies) {
        if (c.piece.data == nullptr) break;
        const ByteView bytes(c.piece.data, static_cast<size_t>(c.piece.size));
        if (c.texels) {
            c.back.words = unpack_texels(c.format, bytes);
        } else {
            c.back.words.resize(bytes.size() / 4);
            std::memcpy(c.back.words.data(), bytes.data(), c.back.words.size() * 4);
        }
        if (c.depth) {
            const float cleared = cleared_depth(frame.request);
            uint32_t bits;
            std::memcpy(&bits, &cleared, 4);
            for (const uint32_t w : c.back.words) out.covered += w != bits ? 1 : 0;
        }
        out.values.push_back(std::move(c.back));
    }
    const std::array<uint32_t, 3>& groups = frame.inputs.groups;
    if (frame.pipeline.compute) out.covered = uint64_t{groups[0]} * groups[1] * groups[2];
    return out;
}

void VulkanDevice::release(Frame& frame) {
    vkDestroyFramebuffer(context_->device, frame.framebuffer, nullptr);
    destroy(*context_, frame.bound);
}

bool VulkanDevice::draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, RunOutput& out) {
    if (!begin(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT)) return false;
    Frame frame{request, pipeline, inputs, {}, {}, {}, {}, VK_NULL_HANDLE};
    bind(frame);
    if (!context_->failed() && context_->lacking.empty()) {
        record_state(frame);
        record_draw(frame, pipeline.pass);
        full_barrier(commands_);
        record_read(frame);
    }
    full_barrier(commands_);
    const bool good = end_and_submit();
    if (good) out = take_output(frame);
    release(frame);
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

bool VulkanDevice::prepare(const PipelineRequest& request, Pipeline& pipeline, std::vector<std::string>& errors,
                           std::string& unsupported) {
    Context& vk = *context_;
    vk.messages.clear();
    vk.failure.clear();
    vk.lacking.clear();
    // The layer walks a module's words before it validates them, so what it gets must be valid already.
    for (const StageCode& s : request.stages)
        if (const std::string why = invalid(s.words); !why.empty()) {
            errors.push_back(std::string("spirv-val, ") + name_of(s.stage) + " stage: " + why);
            return false;
        }
    make_pipeline(vk, request, pipeline, unsupported);
    return unsupported.empty() && !vk.failed() && vk.messages.empty();
}

Status VulkanDevice::settle(std::vector<std::string>& errors, std::string& unsupported) {
    const Context& vk = *context_;
    // A capability or extension that the device lacks is the device's limit, not the module's fault. So is a driver whose own
    // parser gives up on words that spirv-val accepted: Mesa 22.3 does on OpCopyLogical.
    bool all_missing = !vk.messages.empty();
    for (const LayerMessage& m : vk.messages) {
        all_missing &= m.id == "VUID-VkShaderModuleCreateInfo-pCode-01091" ||
                       m.id == "VUID-VkShaderModuleCreateInfo-pCode-04147" ||
                       m.text.find("SPIR-V parsing FAILED") != std::string::npos;
        errors.push_back(m.text);
    }
    if (all_missing) {
        unsupported = errors.front();
        errors.clear();
    }
    if (unsupported.empty() && errors.empty()) unsupported = vk.lacking;
    if (vk.failed() && unsupported.empty()) errors.push_back(vk.failure);
    if (vk.failure.find("VkResult -4") != std::string::npos) return environment_error("the Vulkan device is lost: " + vk.failure);
    return {};
}

Result<PipelineOutput> VulkanDevice::run(const PipelineRequest& request) {
    PipelineOutput out;
    Pipeline pipeline;
    const double start = now_ms();
    const bool ready = prepare(request, pipeline, out.errors, out.unsupported);
    out.create_ms = now_ms() - start;
    if (ready)
        for (const Inputs& inputs : request.inputs) {
            RunOutput run;
            if (!draw(request, pipeline, inputs, run)) break;
            out.runs.push_back(std::move(run));
        }
    destroy(*context_, pipeline);
    out.run_ms = now_ms() - start - out.create_ms;
    KILN_TRY(settle(out.errors, out.unsupported));
    return out;
}

Result<std::unique_ptr<Device>> open_vulkan_device(const DriverChoice& choice) {
    Result<std::string> icd = find_driver(choice);
    KILN_TRY(icd);
    KILN_TRY(apply_driver(*icd, choice));
    Result<std::unique_ptr<Context>> context = Context::open(choice.layer);
    KILN_TRY(context);
    (*context)->info.settings = driver_settings();
    auto device = std::make_unique<VulkanDevice>(std::move(*context));
    if (!device->usable()) return environment_error("the Vulkan device refuses our own set-up");
    return std::unique_ptr<Device>(std::move(device));
}

}  // namespace kiln
