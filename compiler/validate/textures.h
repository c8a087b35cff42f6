#pragma once
// Generated images (policy: inputs.h). Equal requests share one image, so that a device can keep what it uploaded.

#include "compiler/validate/device.h"

namespace kiln {

// The image for one descriptor of `resource`. Storage images have one mip.
std::shared_ptr<const ImageData> make_image(const Resource& resource, uint64_t seed, bool either_sign);

}  // namespace kiln
