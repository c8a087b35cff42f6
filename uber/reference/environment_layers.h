#pragma once
// Prefiltered environments in layers, as uber/lib/environment_layers.glsl names them. maps: callable (layer, direction, level) ->
// radiance.

#include "uber/reference/environment.h"

namespace kiln::reference {

template <class Maps, class T>
Vec3<T> sample_environment_layer(const Maps& maps, int layer, const Vec3<T>& r, const T& roughness, const T& levels) {
    return sample_environment([&](const Vec3<T>& d, const T& level) { return maps(layer, d, level); }, r, roughness, levels);
}

}  // namespace kiln::reference
