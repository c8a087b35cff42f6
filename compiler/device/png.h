#pragma once
// PNG files, 8-bit sRGB.

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

// `rgb`: width * height * 3 bytes, rows from the top.
Result<Bytes> encode_png(ByteView rgb, uint32_t width, uint32_t height);

}  // namespace kiln
