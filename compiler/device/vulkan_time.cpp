// One submission a sample. The timestamps stand outside the render pass with full barriers between them and the draw: a tiler
// (llvmpipe is one) carries out what is recorded inside a pass tile by tile, and a timestamp there would be that of the last
// tile. Attachments are cleared before the first timestamp, and the pass loads them.

#include <algorithm>

#include "compiler/device/vulkan_run.h"

namespace kiln {

namespace {

constexpr VkPipelineStageFlagBits first_stage = VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT;
constexpr VkPipelineStageFlagBits last_stage = VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT;

}  // namespace

void VulkanDevice::record_clears(const Frame& frame) {
    for (const Image* image : frame.attachments) {
        image_barrier(commands_, *image, VK_IMAGE_LAYOUT_UNDEFINED);
        const VkImageSubresourceRange all{image->aspect, 0, 1, 0, 1};
        if (image->format.coding == Coding::depth) {
            const VkClearDepthStencilValue value{cleared_depth(frame.request), 0};
            vkCmdClearDepthStencilImage(commands_, image->image, VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
        } else {
            const VkClearColorValue value{};
            vkCmdClearColorImage(commands_, image->image, VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
        }
    }
}

bool VulkanDevice::submit_timed(const Frame& frame, VkQueryPool queries, uint64_t& ns) {
    if (!begin(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT)) return false;
    vkCmdResetQueryPool(commands_, queries, 0, 2);
    record_clears(frame);
    record_state(frame);
    full_barrier(commands_);
    vkCmdWriteTimestamp(commands_, first_stage, queries, 0);
    record_draw(frame, frame.pipeline.load_pass);
    full_barrier(commands_);
    vkCmdWriteTimestamp(commands_, last_stage, queries, 1);
    if (!end_and_submit()) return false;
    uint64_t ticks[2] = {0, 0};
    if (!context_->ok(vkGetQueryPoolResults(context_->device, queries, 0, 2, sizeof ticks, ticks, sizeof ticks[0],
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                      "vkGetQueryPoolResults"))
        return false;
    const uint64_t mask = context_->timestamp_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << context_->timestamp_bits) - 1;
    ns = static_cast<uint64_t>(static_cast<double>((ticks[1] - ticks[0]) & mask) *
                               static_cast<double>(context_->properties.limits.timestampPeriod));
    return true;
}

bool VulkanDevice::measure(const PipelineRequest& request, const Pipeline& pipeline, const TimeOptions& options,
                           TimedOutput& out) {
    Inputs inputs = request.inputs.front();
    Frame frame{request, pipeline, inputs, {}, {}, {}, {}, VK_NULL_HANDLE};
    VkQueryPool queries = VK_NULL_HANDLE;
    VkQueryPoolCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = 2;
    bool good = context_->ok(vkCreateQueryPool(context_->device, &create, nullptr, &queries), "vkCreateQueryPool") &&
                begin(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT);
    if (good) {
        bind(frame);
        good = end_and_submit();
    }
    const auto submit = [&] {
        uint64_t ns = 0;
        good = good && submit_timed(frame, queries, ns);
        return ns;
    };
    const double start = now_ms();
    if (good) submit();
    out.first_ms = now_ms() - start;
    for (uint32_t i = 1; good && i < options.warm_ups; ++i) submit();
    while (good && options.enlarge) {
        const uint64_t once = submit(), again = submit();
        if (!good || !options.enlarge(std::min(once, again), inputs.push_constants, inputs.groups)) break;
    }
    for (uint32_t i = 0; good && i < options.repeats; ++i) out.samples_ns.push_back(submit());
    if (good && begin(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT)) {
        full_barrier(commands_);
        record_read(frame);
        full_barrier(commands_);
        good = end_and_submit();
        if (good) out.last = take_output(frame);
    }
    release(frame);
    vkDestroyQueryPool(context_->device, queries, nullptr);
    return good;
}

Result<TimedOutput> VulkanDevice::time(const PipelineRequest& request, const TimeOptions& options) {
    TimedOutput out;
    Pipeline pipeline;
    const double start = now_ms();
    bool ready = prepare(request, pipeline, out.errors, out.unsupported);
    out.create_ms = now_ms() - start;
    if (ready && context_->timestamp_bits == 0) out.unsupported = "this device's queue has no timestamps";
    if (ready && !pipeline.compute) make_load_pass(*context_, pipeline);
    if (ready && out.unsupported.empty() && !context_->failed() && !measure(request, pipeline, options, out))
        out.samples_ns.clear();
    destroy(*context_, pipeline);
    KILN_TRY(settle(out.errors, out.unsupported));
    return out;
}

}  // namespace kiln
