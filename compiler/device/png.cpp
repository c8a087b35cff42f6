// libpng's simplified interface: no setjmp, errors as text.

#include "compiler/device/png.h"

#include <png.h>

#include <string>

namespace kiln {

Result<Bytes> encode_png(ByteView rgb, uint32_t width, uint32_t height) {
    if (width == 0 || height == 0 || rgb.size() != size_t{width} * height * 3)
        return environment_error("a picture's size does not fit its pixels");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = 0;
    if (png_image_write_get_memory_size(image, size, 0, rgb.data(), 0, nullptr) == 0)
        return environment_error(std::string("libpng: ") + image.message);
    Bytes out(size);
    if (png_image_write_to_memory(&image, out.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
        return environment_error(std::string("libpng: ") + image.message);
    out.resize(size);
    return out;
}

}  // namespace kiln
