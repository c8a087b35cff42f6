#pragma once
// The device's own parts: what every run records, and what tells what came of it. Internal to compiler/device.

#include <map>

#include "compiler/base/digest.h"
#include "compiler/device/bind.h"

namespace kiln {

class VulkanDevice final : public Device {
public:
    explicit VulkanDevice(std::unique_ptr<Context> context);
    ~VulkanDevice() override;

    const DeviceInfo& info() const override { return context_->info; }
    bool usable() const { return !context_->failed(); }
    Result<PipelineOutput> run(const PipelineRequest& request) override;
    Result<TimedOutput> time(const PipelineRequest& request, const TimeOptions& options) override;

private:
    struct Copy {
        ReadBack back;
        Format format;
        Piece piece;
        bool texels = true;  // unpack by format; else raw words
        bool depth = false;
    };
    // One set of inputs, bound, with the attachments it is drawn into and what is copied back.
    struct Frame {
        const PipelineRequest& request;
        const Pipeline& pipeline;
        const Inputs& inputs;
        Bound bound;
        std::vector<Piece> vertices;      // by attribute
        std::vector<Image*> attachments;  // colours by location, then depth; none for compute
        std::vector<Copy> copies;         // of attachments, in their order, then of what shaders wrote
        VkFramebuffer framebuffer = VK_NULL_HANDLE;
    };

    // vulkan_device.cpp: each records into commands_ or does nothing once the context has failed.
    bool begin(VkCommandBufferUsageFlags flags);
    void bind(Frame& frame);
    void record_state(const Frame& frame);
    void record_draw(const Frame& frame, VkRenderPass pass);
    void record_read(Frame& frame);
    bool end_and_submit();  // and waits; false where the layer or the driver objected
    RunOutput take_output(Frame& frame);
    void release(Frame& frame);

    bool draw(const PipelineRequest& request, const Pipeline& pipeline, const Inputs& inputs, RunOutput& out);
    bool copy_image(Image& image, Copy& copy);
    void make_framebuffer(Frame& frame);
    const std::string& invalid(const Words& words);
    // The pipeline of a request; false when there is none, with the reason in `errors`, `unsupported` or the context.
    bool prepare(const PipelineRequest& request, Pipeline& pipeline, std::vector<std::string>& errors, std::string& unsupported);
    // Sorts what the layer and the driver said; an Error when the device is lost.
    Status settle(std::vector<std::string>& errors, std::string& unsupported);

    // vulkan_time.cpp
    bool measure(const PipelineRequest& request, const Pipeline& pipeline, const TimeOptions& options, TimedOutput& out);
    void record_clears(const Frame& frame);
    bool submit_timed(const Frame& frame, VkQueryPool queries, uint64_t& ns);

    std::map<Fast, std::string> validated_;
    std::unique_ptr<Context> context_;
    Arena arena_;
    Images images_;
    Samplers samplers_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

double now_ms();

// What attachments are cleared to: nothing, and a depth that no shader is likely to write, from which coverage is told.
float cleared_depth(const PipelineRequest& request);

}  // namespace kiln
