#include "compiler/device/pipeline.h"

#include <algorithm>
#include <map>

#include "compiler/device/facts.h"
#include "compiler/device/spare.h"

namespace kiln {

namespace {

bool good(const Context& context) { return !context.failed() && context.messages.empty(); }

VkShaderStageFlags users(const PipelineRequest& request, uint32_t set, uint32_t binding) {
    VkShaderStageFlags out = 0;
    for (const StageCode& s : request.stages)
        for (const Resource& r : s.reflection.resources)
            if (r.kind != ResourceKind::push_constants && r.set == set && r.binding == binding) out |= stage_bit(s.stage);
    return out;
}

void make_modules(Context& context, const PipelineRequest& request, Pipeline& out) {
    for (const StageCode& s : request.stages) {
        VkShaderModuleCreateInfo create{};
        create.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        create.codeSize = s.words.size() * 4;
        create.pCode = s.words.data();
        VkShaderModule module = VK_NULL_HANDLE;
        if (!context.ok(vkCreateShaderModule(context.device, &create, nullptr, &module), "vkCreateShaderModule")) return;
        out.modules.push_back(module);
    }
}

void make_layout(Context& context, const PipelineRequest& request, Pipeline& out) {
    const Inputs& inputs = request.inputs.front();
    std::map<uint32_t, std::vector<VkDescriptorSetLayoutBinding>> sets;
    std::vector<UniformUse> uniforms;
    for (const Binding& b : inputs.bindings)
        if (b.kind == ResourceKind::uniform_block) uniforms.push_back({b.descriptors, users(request, b.set, b.binding)});
    const std::vector<uint32_t> spare =
        spare_descriptors(uniforms, context.properties.limits.maxPerStageDescriptorUniformBuffers);
    size_t uniform = 0;
    for (const Binding& b : inputs.bindings) {
        const uint32_t more = b.kind == ResourceKind::uniform_block ? spare[uniform++] : 0;
        if (more != 0) out.spare[{b.set, b.binding}] = more;
        sets[b.set].push_back(
            {b.binding, descriptor_type(b.kind), b.descriptors + more, users(request, b.set, b.binding), nullptr});
    }
    const uint32_t count = sets.empty() ? 0 : sets.rbegin()->first + 1;
    if (count > context.properties.limits.maxBoundDescriptorSets) {
        context.failure = "descriptor set " + std::to_string(count - 1) + " is past the device's limit of " +
                          std::to_string(context.properties.limits.maxBoundDescriptorSets) + " sets";
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        VkDescriptorSetLayoutCreateInfo create{};
        create.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
        create.bindingCount = static_cast<uint32_t>(sets[i].size());
        create.pBindings = sets[i].data();
        VkDescriptorSetLayout layout = VK_NULL_HANDLE;
        if (!context.ok(vkCreateDescriptorSetLayout(context.device, &create, nullptr, &layout), "vkCreateDescriptorSetLayout"))
            return;
        out.sets.push_back(layout);
    }
    for (const StageCode& s : request.stages)
        for (const Resource& r : s.reflection.resources)
            if (r.kind == ResourceKind::push_constants) out.push_stages |= stage_bit(s.stage);
    const VkPushConstantRange range{out.push_stages, 0, static_cast<uint32_t>(inputs.push_constants.size())};
    VkPipelineLayoutCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    create.setLayoutCount = count;
    create.pSetLayouts = out.sets.data();
    create.pushConstantRangeCount = out.push_stages != 0 ? 1 : 0;
    create.pPushConstantRanges = &range;
    context.ok(vkCreatePipelineLayout(context.device, &create, nullptr, &out.layout), "vkCreatePipelineLayout");
}

void find_outputs(const Reflection& fragment, uint32_t limit, Pipeline& out) {
    std::map<uint32_t, Output> by_location;
    for (const Varying& v : fragment.outputs) {
        if (v.index != 0) continue;  // the second source of dual-source blending, which we do not do
        uint32_t n = 1;
        for (const uint32_t dim : v.type.array) n = std::min(n * std::max(1u, dim), limit);
        for (uint32_t l = 0; l < n; ++l) {
            Output& o = by_location[v.location + l];
            o.location = v.location + l;
            o.base = v.type.base;
            o.mask |= ((1u << v.type.rows) - 1) << v.component & 15u;
        }
    }
    const uint32_t end = by_location.empty() ? 0 : std::min(by_location.rbegin()->first + 1, limit);
    for (uint32_t l = 0; l < end; ++l) {
        Output o = by_location[l];
        o.location = l;
        out.outputs.push_back(o);
    }
}

Format output_format(BaseType base) {
    switch (base) {
        case BaseType::int32:
        case BaseType::int16:
        case BaseType::int8:
            return format_of(0, BaseType::int32);
        case BaseType::uint32:
        case BaseType::uint16:
        case BaseType::uint8:
            return format_of(0, BaseType::uint32);
        default:
            return format_of(0, BaseType::float32);
    }
}

void find_input_images(const PipelineRequest& request, Pipeline& out) {
    for (const StageCode& s : request.stages)
        for (const auto& [slot, index] : facts_of(s.words).input_attachment_index)
            for (const Resource& r : s.reflection.resources)
                if (r.kind == ResourceKind::input_attachment && r.set == slot.first && r.binding == slot.second)
                    out.inputs.push_back(
                        {index, format_of(0, r.sampled), r.multisampled ? VK_SAMPLE_COUNT_4_BIT : VK_SAMPLE_COUNT_1_BIT});
    std::sort(out.inputs.begin(), out.inputs.end(), [](const InputImage& a, const InputImage& b) { return a.index < b.index; });
}

VkRenderPass make_pass(Context& context, const Pipeline& out, VkAttachmentLoadOp own) {
    const VkImageLayout before = own == VK_ATTACHMENT_LOAD_OP_CLEAR ? VK_IMAGE_LAYOUT_UNDEFINED : VK_IMAGE_LAYOUT_GENERAL;
    std::vector<VkAttachmentDescription> attachments;
    std::vector<VkAttachmentReference> colours, inputs;
    const auto add = [&](VkFormat format, VkAttachmentLoadOp load, VkImageLayout from,
                         VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT) {
        attachments.push_back({0, format, samples, load, VK_ATTACHMENT_STORE_OP_STORE, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                               VK_ATTACHMENT_STORE_OP_DONT_CARE, from, VK_IMAGE_LAYOUT_GENERAL});
        return static_cast<uint32_t>(attachments.size() - 1);
    };
    for (const Output& o : out.outputs)
        colours.push_back(o.mask == 0
                              ? VkAttachmentReference{VK_ATTACHMENT_UNUSED, VK_IMAGE_LAYOUT_UNDEFINED}
                              : VkAttachmentReference{add(output_format(o.base).vk, own, before), VK_IMAGE_LAYOUT_GENERAL});
    const VkAttachmentReference depth{add(depth_format().vk, own, before), VK_IMAGE_LAYOUT_GENERAL};
    for (const InputImage& i : out.inputs) {
        while (inputs.size() < i.index && i.index < 64) inputs.push_back({VK_ATTACHMENT_UNUSED, VK_IMAGE_LAYOUT_UNDEFINED});
        inputs.push_back(
            {add(i.format.vk, VK_ATTACHMENT_LOAD_OP_LOAD, VK_IMAGE_LAYOUT_GENERAL, i.samples), VK_IMAGE_LAYOUT_GENERAL});
    }
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = static_cast<uint32_t>(colours.size());
    subpass.pColorAttachments = colours.data();
    subpass.inputAttachmentCount = static_cast<uint32_t>(inputs.size());
    subpass.pInputAttachments = inputs.data();
    subpass.pDepthStencilAttachment = &depth;
    VkRenderPassCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    create.attachmentCount = static_cast<uint32_t>(attachments.size());
    create.pAttachments = attachments.data();
    create.subpassCount = 1;
    create.pSubpasses = &subpass;
    VkRenderPass pass = VK_NULL_HANDLE;
    context.ok(vkCreateRenderPass(context.device, &create, nullptr, &pass), "vkCreateRenderPass");
    return pass;
}

std::vector<VkPipelineShaderStageCreateInfo> stages_of(const PipelineRequest& request, const Pipeline& pipeline) {
    std::vector<VkPipelineShaderStageCreateInfo> out;
    for (size_t i = 0; i < request.stages.size(); ++i) {
        VkPipelineShaderStageCreateInfo s{};
        s.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        s.stage = stage_bit(request.stages[i].stage);
        s.module = pipeline.modules[i];
        s.pName = request.stages[i].reflection.entry.c_str();
        out.push_back(s);
    }
    return out;
}

VkPrimitiveTopology topology_of(const PipelineRequest& request) {
    for (const StageCode& s : request.stages)
        if (s.stage == Stage::tess_control || s.stage == Stage::tess_evaluation) return VK_PRIMITIVE_TOPOLOGY_PATCH_LIST;
    for (const StageCode& s : request.stages)
        if (s.stage == Stage::geometry) switch (facts_of(s.words).input_vertices) {
                case 1:
                    return VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
                case 2:
                    return VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
                case 4:
                    return VK_PRIMITIVE_TOPOLOGY_LINE_LIST_WITH_ADJACENCY;
                case 6:
                    return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST_WITH_ADJACENCY;
                default:
                    break;
            }
    return VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
}

void make_graphics(Context& context, const PipelineRequest& request, Pipeline& out) {
    const std::vector<VkPipelineShaderStageCreateInfo> stages = stages_of(request, out);
    std::vector<VkVertexInputBindingDescription> bindings;
    std::vector<VkVertexInputAttributeDescription> attributes;
    for (const Attribute& a : request.inputs.front().attributes) {
        const uint32_t binding = static_cast<uint32_t>(bindings.size());
        const uint32_t width = a.base == BaseType::float64 || a.base == BaseType::int64 || a.base == BaseType::uint64 ? 8 : 4;
        bindings.push_back({binding, a.components * width, VK_VERTEX_INPUT_RATE_VERTEX});
        attributes.push_back({a.location, binding, vertex_format(a.base, a.components), 0});
    }
    VkPipelineVertexInputStateCreateInfo vertices{};
    vertices.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    vertices.vertexBindingDescriptionCount = static_cast<uint32_t>(bindings.size());
    vertices.pVertexBindingDescriptions = bindings.data();
    vertices.vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size());
    vertices.pVertexAttributeDescriptions = attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = topology_of(request);
    VkPipelineTessellationStateCreateInfo patches{};
    patches.sType = VK_STRUCTURE_TYPE_PIPELINE_TESSELLATION_STATE_CREATE_INFO;
    patches.patchControlPoints = 3;
    for (const StageCode& s : request.stages)
        if (s.stage == Stage::tess_control) patches.patchControlPoints = std::clamp(facts_of(s.words).output_vertices, 1u, 32u);
    const VkViewport viewport{0, 0, static_cast<float>(request.size), static_cast<float>(request.rows()), 0, 1};
    const VkRect2D scissor{{0, 0}, {request.size, request.rows()}};
    VkPipelineViewportStateCreateInfo view{};
    view.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    view.viewportCount = view.scissorCount = 1;
    view.pViewports = &viewport;
    view.pScissors = &scissor;
    VkPipelineRasterizationStateCreateInfo raster{};
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.depthClampEnable = request.depth_test ? VK_FALSE : context.features.depthClamp;
    raster.cullMode = request.cull_back ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples{};
    samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{};
    depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = request.depth_test ? VK_COMPARE_OP_LESS_OR_EQUAL : VK_COMPARE_OP_ALWAYS;
    std::vector<VkPipelineColorBlendAttachmentState> blends(out.outputs.size());
    for (size_t i = 0; i < blends.size(); ++i) blends[i].colorWriteMask = out.outputs[i].mask;
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = static_cast<uint32_t>(blends.size());
    blend.pAttachments = blends.data();
    VkGraphicsPipelineCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    create.stageCount = static_cast<uint32_t>(stages.size());
    create.pStages = stages.data();
    create.pVertexInputState = out.mesh ? nullptr : &vertices;
    create.pInputAssemblyState = out.mesh ? nullptr : &assembly;
    create.pTessellationState = assembly.topology == VK_PRIMITIVE_TOPOLOGY_PATCH_LIST ? &patches : nullptr;
    create.pViewportState = &view;
    create.pRasterizationState = &raster;
    create.pMultisampleState = &samples;
    create.pDepthStencilState = &depth;
    create.pColorBlendState = &blend;
    create.layout = out.layout;
    create.renderPass = out.pass;
    context.ok(vkCreateGraphicsPipelines(context.device, VK_NULL_HANDLE, 1, &create, nullptr, &out.pipeline),
               "vkCreateGraphicsPipelines");
}

void make_compute(Context& context, const PipelineRequest& request, Pipeline& out) {
    VkComputePipelineCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    create.stage = stages_of(request, out).front();
    create.layout = out.layout;
    context.ok(vkCreateComputePipelines(context.device, VK_NULL_HANDLE, 1, &create, nullptr, &out.pipeline),
               "vkCreateComputePipelines");
}

}  // namespace

VkShaderStageFlagBits stage_bit(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return VK_SHADER_STAGE_VERTEX_BIT;
        case Stage::tess_control:
            return VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT;
        case Stage::tess_evaluation:
            return VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT;
        case Stage::geometry:
            return VK_SHADER_STAGE_GEOMETRY_BIT;
        case Stage::fragment:
            return VK_SHADER_STAGE_FRAGMENT_BIT;
        case Stage::task:
            return VK_SHADER_STAGE_TASK_BIT_EXT;
        case Stage::mesh:
            return VK_SHADER_STAGE_MESH_BIT_EXT;
        default:
            return VK_SHADER_STAGE_COMPUTE_BIT;
    }
}

VkDescriptorType descriptor_type(ResourceKind kind) {
    switch (kind) {
        case ResourceKind::storage_block:
            return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case ResourceKind::combined_image:
            return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        case ResourceKind::separate_image:
            return VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
        case ResourceKind::separate_sampler:
            return VK_DESCRIPTOR_TYPE_SAMPLER;
        case ResourceKind::storage_image:
            return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        case ResourceKind::uniform_texels:
            return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        case ResourceKind::storage_texels:
            return VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
        case ResourceKind::input_attachment:
            return VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT;
        default:
            return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    }
}

void make_pipeline(Context& context, const PipelineRequest& request, Pipeline& out, std::string& unsupported) {
    bool pre_raster = false;
    for (const StageCode& s : request.stages) {
        if (s.stage >= Stage::raygen) unsupported = "no ray tracing pipelines on this device";
        if (s.stage == Stage::mesh || s.stage == Stage::task) out.mesh = true;
        if (s.stage == Stage::compute) out.compute = true;
        pre_raster |= s.stage == Stage::vertex || s.stage == Stage::mesh;
        for (const Resource& r : s.reflection.resources)
            if (r.kind == ResourceKind::acceleration_structure) unsupported = "no acceleration structures on this device";
    }
    if (out.mesh && !context.mesh_shaders) unsupported = "no mesh shaders on this device";
    if (!unsupported.empty()) return;
    if (out.compute ? request.stages.size() != 1 : !pre_raster) {
        context.failure = "the stages do not make a pipeline";
        return;
    }
    make_modules(context, request, out);
    if (!good(context)) return;
    make_layout(context, request, out);
    if (!good(context)) return;
    if (out.compute) return make_compute(context, request, out);
    for (const StageCode& s : request.stages)
        if (s.stage == Stage::fragment) find_outputs(s.reflection, context.properties.limits.maxColorAttachments, out);
    find_input_images(request, out);
    out.pass = make_pass(context, out, VK_ATTACHMENT_LOAD_OP_CLEAR);
    if (good(context)) make_graphics(context, request, out);
}

void make_load_pass(Context& context, Pipeline& pipeline) {
    pipeline.load_pass = make_pass(context, pipeline, VK_ATTACHMENT_LOAD_OP_LOAD);
}

void destroy(Context& context, Pipeline& p) {
    vkDestroyPipeline(context.device, p.pipeline, nullptr);
    vkDestroyRenderPass(context.device, p.load_pass, nullptr);
    vkDestroyRenderPass(context.device, p.pass, nullptr);
    vkDestroyPipelineLayout(context.device, p.layout, nullptr);
    for (const VkDescriptorSetLayout s : p.sets) vkDestroyDescriptorSetLayout(context.device, s, nullptr);
    for (const VkShaderModule m : p.modules) vkDestroyShaderModule(context.device, m, nullptr);
    p = {};
}

}  // namespace kiln
