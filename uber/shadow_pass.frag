#version 450
// Fragment stage of shadow_pass. A plain map is the depth attachment alone; moments go to a 32-bit float colour attachment
// beside it, and moments.comp sums or averages them.

#include "shadow_pass_axes.glsl"
#include "shadow_pass_interface.glsl"
#if KIND == KIND_MOMENTS
#include "lib/vsm.glsl"
#endif

#if ALPHA_TEST
layout(set = 1, binding = 1) uniform sampler2D base_map;    // a: opacity
layout(location = 1) in vec2 material_uv;
#endif
#if KIND == KIND_MOMENTS
layout(location = 0) in float light_distance;
layout(location = 0) out vec2 moments;    // E(q), E(q^2), RG32F
#endif

void main() {
#if KIND == KIND_MOMENTS
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    const float far = 1.0;    // orthographic depth is linear and already in units of the map's range
#else
    const float far = moments_far;
#endif
    // Before the discard: derivatives need the whole quad. A steep plane's are cut at a tenth of the range.
    const vec2 gradient = clamp(vec2(dFdx(light_distance), dFdy(light_distance)) / far, vec2(-0.1), vec2(0.1));
#endif
#if ALPHA_TEST
    if (texture(base_map, material_uv).a < alpha_threshold) {
        discard;
    }
#endif
#if KIND == KIND_MOMENTS
    moments = shadow_moments(light_distance, far, moments_reference, gradient);
#endif
}
