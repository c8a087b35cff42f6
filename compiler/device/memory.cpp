#include "compiler/device/memory.h"

#include <algorithm>
#include <cstring>

#include "compiler/validate/texels.h"

namespace kiln {

namespace {
constexpr size_t chunk_bytes = 8u << 20;
constexpr size_t alignment = 256;  // the largest that Vulkan lets a device ask of any buffer offset
constexpr VkMemoryPropertyFlags host_memory = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
}  // namespace

Arena::~Arena() {
    for (const Chunk& c : chunks_) {
        vkDestroyBuffer(context_.device, c.buffer, nullptr);
        vkFreeMemory(context_.device, c.memory, nullptr);
    }
}

Piece Arena::take(size_t bytes) {
    const size_t wanted = (std::max<size_t>(bytes, 1) + alignment - 1) / alignment * alignment;
    while (chunk_ < chunks_.size() && chunks_[chunk_].size - used_ < wanted) ++chunk_, used_ = 0;
    if (chunk_ == chunks_.size()) {
        Chunk c;
        c.size = std::max(chunk_bytes, wanted);
        VkBufferCreateInfo create{};
        create.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
        create.size = c.size;
        create.usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                       VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT |
                       VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        if (!context_.ok(vkCreateBuffer(context_.device, &create, nullptr, &c.buffer), "vkCreateBuffer")) return {};
        VkMemoryRequirements needs{};
        vkGetBufferMemoryRequirements(context_.device, c.buffer, &needs);
        VkMemoryAllocateInfo allocate{};
        allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        allocate.allocationSize = needs.size;
        allocate.memoryTypeIndex = context_.memory_type(needs.memoryTypeBits, host_memory);
        void* mapped = nullptr;
        const bool good = context_.ok(vkAllocateMemory(context_.device, &allocate, nullptr, &c.memory), "vkAllocateMemory") &&
                          context_.ok(vkBindBufferMemory(context_.device, c.buffer, c.memory, 0), "vkBindBufferMemory") &&
                          context_.ok(vkMapMemory(context_.device, c.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
        c.data = static_cast<uint8_t*>(mapped);
        chunks_.push_back(c);
        if (!good) return {};
    }
    const Chunk& c = chunks_[chunk_];
    if (c.data == nullptr) return {};
    Piece out{c.buffer, used_, bytes, c.data + used_};
    std::memset(out.data, 0, bytes);
    used_ += wanted;
    return out;
}

Piece Arena::take(ByteView content) {
    const Piece out = take(content.size());
    if (out.data != nullptr && !content.empty()) std::memcpy(out.data, content.data(), content.size());
    return out;
}

void image_barrier(VkCommandBuffer commands, const Image& image, VkImageLayout from) {
    VkImageMemoryBarrier b{};
    b.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    b.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    b.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    b.oldLayout = from;
    b.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    b.srcQueueFamilyIndex = b.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    b.image = image.image;
    b.subresourceRange = {image.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0,
                         nullptr, 1, &b);
}

void full_barrier(VkCommandBuffer commands) {
    VkMemoryBarrier b{};
    b.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
    b.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    b.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &b, 0, nullptr, 0, nullptr);
}

Image Images::make(const ImageData& like, const Format& format, VkImageUsageFlags usage) {
    Image out;
    out.format = format;
    out.aspect = format.coding == Coding::depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    out.width = like.width;
    out.height = like.height;
    out.slices = like.slices;
    out.layers = like.layers;
    out.mips = like.mips;
    VkImageCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    if (like.dim == ImageDim::cube) create.flags = VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT;
    create.imageType = like.dim == ImageDim::d1   ? VK_IMAGE_TYPE_1D
                       : like.dim == ImageDim::d3 ? VK_IMAGE_TYPE_3D
                                                  : VK_IMAGE_TYPE_2D;
    create.format = format.vk;
    create.extent = {like.width, like.height, like.slices};
    create.mipLevels = like.mips;
    create.arrayLayers = like.layers;
    create.samples = like.multisampled ? VK_SAMPLE_COUNT_4_BIT : VK_SAMPLE_COUNT_1_BIT;
    create.usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (!context_.ok(vkCreateImage(context_.device, &create, nullptr, &out.image), "vkCreateImage")) return {};
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(context_.device, out.image, &needs);
    VkMemoryAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex = context_.memory_type(needs.memoryTypeBits, 0);
    VkImageViewCreateInfo view{};
    view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    view.image = out.image;
    view.format = format.vk;
    view.subresourceRange = {out.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    switch (like.dim) {
        case ImageDim::d1:
            view.viewType = like.arrayed ? VK_IMAGE_VIEW_TYPE_1D_ARRAY : VK_IMAGE_VIEW_TYPE_1D;
            break;
        case ImageDim::d3:
            view.viewType = VK_IMAGE_VIEW_TYPE_3D;
            break;
        case ImageDim::cube:
            view.viewType = like.arrayed ? VK_IMAGE_VIEW_TYPE_CUBE_ARRAY : VK_IMAGE_VIEW_TYPE_CUBE;
            break;
        default:
            view.viewType = like.arrayed ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
            break;
    }
    if (!context_.ok(vkAllocateMemory(context_.device, &allocate, nullptr, &out.memory), "vkAllocateMemory") ||
        !context_.ok(vkBindImageMemory(context_.device, out.image, out.memory, 0), "vkBindImageMemory") ||
        !context_.ok(vkCreateImageView(context_.device, &view, nullptr, &out.view), "vkCreateImageView"))
        out.view = VK_NULL_HANDLE;
    return out;
}

void Images::upload(VkCommandBuffer commands, Image& image, const ImageData& data) {
    image_barrier(commands, image, image.ready ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_UNDEFINED);
    image.ready = true;
    if (data.multisampled) {  // cannot be copied into; every sample gets the first texel
        const VkImageSubresourceRange all{image.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
        if (data.depth) {
            VkClearDepthStencilValue value{0.5f, 0};
            vkCmdClearDepthStencilImage(commands, image.image, VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
        } else {
            VkClearColorValue value{};
            std::memcpy(&value, data.texels.data(), std::min<size_t>(data.texels.size(), sizeof value));
            vkCmdClearColorImage(commands, image.image, VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
        }
        image_barrier(commands, image, VK_IMAGE_LAYOUT_GENERAL);
        return;
    }
    if (data.texels.size() != image_bytes(data)) {
        context_.failure = "an image of " + std::string(name_of(data.format)) + " texels has " +
                           std::to_string(data.texels.size()) + " bytes, and its size asks for " +
                           std::to_string(image_bytes(data));
        return;
    }
    size_t at = 0;
    for (uint32_t mip = 0; mip < image.mips; ++mip) {
        const ByteView texels = ByteView(data.texels).subspan(at, mip_bytes(data, mip));
        at += texels.size();
        // Each mip is staged on its own: an offset must be a multiple of 4 and of a block, which tight packing does not give.
        const Piece staged =
            data.format == TexelFormat::standard ? arena_.take(pack_texels(image.format, texels)) : arena_.take(texels);
        if (staged.data == nullptr) return;
        VkBufferImageCopy copy{};
        copy.bufferOffset = staged.offset;
        copy.imageSubresource = {image.aspect, mip, 0, image.layers};
        copy.imageExtent = {std::max(1u, image.width >> mip), std::max(1u, image.height >> mip),
                            std::max(1u, image.slices >> mip)};
        vkCmdCopyBufferToImage(commands, staged.buffer, image.image, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
    }
    image_barrier(commands, image, VK_IMAGE_LAYOUT_GENERAL);
}

bool Images::can_sample(const ImageData& data, const Format& format) {
    if (data.format != TexelFormat::standard && (data.multisampled || data.dim == ImageDim::subpass)) {
        context_.failure = std::string("multisampled images and input attachments are ") + name_of(TexelFormat::standard) +
                           ", not " + name_of(data.format);
        return false;
    }
    VkFormatProperties have{};
    vkGetPhysicalDeviceFormatProperties(context_.physical, format.vk, &have);
    if ((have.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT) == 0)
        context_.lacking = std::string("this device does not sample ") + name_of(data.format);
    return context_.lacking.empty();
}

Image* Images::sampled(VkCommandBuffer commands, const std::shared_ptr<const ImageData>& data) {
    auto& [kept, image] = sampled_[data.get()];
    kept = data;
    if (image.view == VK_NULL_HANDLE) {
        VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;
        if (data->dim == ImageDim::subpass)
            usage = VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
        else if (data->multisampled)
            usage |= data->depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
        const Format format = format_of(*data);
        if (!can_sample(*data, format)) return nullptr;
        image = make(*data, format, usage);
        if (image.view == VK_NULL_HANDLE) return nullptr;
        sampled_bytes_ += data->texels.size();
        upload(commands, image, *data);
    }
    return &image;
}

Image* Images::storage(VkCommandBuffer commands, const ImageData& data, const Format& format, uint32_t ordinal) {
    if (data.format != TexelFormat::standard) {
        context_.failure = std::string("texels of a storage image are given as standard, not as ") + name_of(data.format);
        return nullptr;
    }
    const Shape shape{data.width, data.height, data.slices, data.layers, data.mips};
    Image& image = storage_[{format.vk, data.dim, data.arrayed, data.multisampled ? 4u : 1u, shape, ordinal}];
    if (image.view == VK_NULL_HANDLE) image = make(data, format, VK_IMAGE_USAGE_STORAGE_BIT);
    if (image.view == VK_NULL_HANDLE) return nullptr;
    upload(commands, image, data);
    return &image;
}

Image* Images::attachment(const Format& format, uint32_t width, uint32_t height, uint32_t ordinal) {
    Image& image = attachments_[{format.vk, width, height, ordinal}];
    if (image.view == VK_NULL_HANDLE) {
        ImageData like;
        like.width = width;
        like.height = height;
        image = make(
            like, format,
            format.coding == Coding::depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    }
    return image.view == VK_NULL_HANDLE ? nullptr : &image;
}

void Images::destroy(Image& image) {
    vkDestroyImageView(context_.device, image.view, nullptr);
    vkDestroyImage(context_.device, image.image, nullptr);
    vkFreeMemory(context_.device, image.memory, nullptr);
    image = {};
}

void Images::clear() {
    for (auto& [key, entry] : sampled_) destroy(entry.second);
    for (auto& [key, image] : storage_) destroy(image);
    for (auto& [key, image] : attachments_) destroy(image);
    sampled_.clear();
    sampled_bytes_ = 0;
    storage_.clear();
    attachments_.clear();
}

}  // namespace kiln
