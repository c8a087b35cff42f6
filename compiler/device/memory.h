#pragma once
// Buffers and images that live across pipelines, since making them costs more than a 64x64 draw. Every image stays in
// VK_IMAGE_LAYOUT_GENERAL. Internal to compiler/device.

#include <map>
#include <tuple>

#include "compiler/device/context.h"
#include "compiler/device/formats.h"

namespace kiln {

// A piece of host-visible memory, good until the arena is reset.
struct Piece {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, size = 0;
    uint8_t* data = nullptr;  // null: out of memory
};

class Arena {
public:
    explicit Arena(Context& context) : context_(context) {}
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;
    ~Arena();
    Piece take(size_t bytes);  // zeroed, aligned to 256
    Piece take(ByteView content);
    void reset() { chunk_ = 0, used_ = 0; }

private:
    struct Chunk {
        VkBuffer buffer = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        uint8_t* data = nullptr;
        size_t size = 0;
    };
    Context& context_;
    std::vector<Chunk> chunks_;
    size_t chunk_ = 0, used_ = 0;
};

struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    Format format;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    uint32_t width = 1, height = 1, slices = 1, layers = 1, mips = 1;
    bool ready = false;  // in GENERAL layout, with its content where that never changes
    size_t texel_count() const { return size_t{width} * height * slices * layers; }  // of mip 0
};

class Images {
public:
    Images(Context& context, Arena& arena) : context_(context), arena_(arena) {}
    Images(const Images&) = delete;
    Images& operator=(const Images&) = delete;
    ~Images() { clear(); }

    // Images that shaders only read keep their content from run to run; the pointer is good until clear().
    Image* sampled(VkCommandBuffer commands, const std::shared_ptr<const ImageData>& data);
    // Filled anew in every run. `ordinal` tells images of one run apart.
    Image* storage(VkCommandBuffer commands, const ImageData& data, const Format& format, uint32_t ordinal);
    Image* attachment(const Format& format, uint32_t width, uint32_t height, uint32_t ordinal);
    bool crowded() const { return sampled_.size() > 512 || storage_.size() > 64 || sampled_bytes_ > (size_t{256} << 20); }
    void clear();

private:
    bool can_sample(const ImageData& data, const Format& format);
    Image make(const ImageData& like, const Format& format, VkImageUsageFlags usage);
    void upload(VkCommandBuffer commands, Image& image, const ImageData& data);
    void destroy(Image& image);

    Context& context_;
    Arena& arena_;
    std::map<const ImageData*, std::pair<std::shared_ptr<const ImageData>, Image>> sampled_;
    size_t sampled_bytes_ = 0;              // as they were given
    using Shape = std::array<uint32_t, 5>;  // width, height, slices, layers, mips
    std::map<std::tuple<VkFormat, ImageDim, bool, uint32_t, Shape, uint32_t>, Image> storage_;
    std::map<std::tuple<VkFormat, uint32_t, uint32_t, uint32_t>, Image> attachments_;
};

// A full barrier on one image: correctness before speed, on images of a few kilobytes.
void image_barrier(VkCommandBuffer commands, const Image& image, VkImageLayout from);
void full_barrier(VkCommandBuffer commands);

}  // namespace kiln
