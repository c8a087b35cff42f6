#ifndef KILN_PCF_CASCADES_GLSL
#define KILN_PCF_CASCADES_GLSL
// Percentage-closer filtering (pcf.glsl) in the layers of cascaded shadow maps (cascades.glsl). A filter ends at its layer's
// border: taps beyond it are lit, so layers overlap by half a filter where they are fitted.
#include "cascades.glsl"
#include "math.glsl"
#include "shadow_receiver.glsl"

// The mean of n x n comparisons over a box in one layer, each against the receiver's plane; 1 where the layer knows nothing of
// the receiver. Zero gradients name the base level, as in cascades.glsl.
// clip: the receiver in that layer's clip space; slope: depth a uv, from receiver_depth_slope; bias: depth, from
// receiver_depth_bias; width: of the box, uv, >= 0; n: 1 to 16.
float cascade_pcf(sampler2DArrayShadow maps, vec4 clip, int layer, vec2 slope, float bias, float width, int n) {
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
    float lit = 0.0;
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            const vec2 offset = ((vec2(x, y) + 0.5) / float(n) - 0.5) * width;
            const vec3 at = vec3(place.xy + offset, place.z + dot(slope, offset) - bias);
            const float tap = textureGrad(maps, vec4(at.xy, float(layer), at.z), vec2(0.0), vec2(0.0));
            lit += all(greaterThanEqual(at.xy, vec2(0.0))) && all(lessThanEqual(at, vec3(1.0))) ? tap : 1.0;
        }
    }
    return lit / float(n * n);
}

// The chosen layers, filtered and blended. clip_of_world: each layer's matrix; plane_of_world: its inverse transpose;
// width: of the box in each layer, uv; texel: side of a texel, uv; quantum: of the map, depth units (shadow_receiver.glsl).
// receiver: world; n: unit normal there; taps: a side, 1 to 16.
float cascaded_pcf(sampler2DArrayShadow maps, mat4 clip_of_world[4], mat4 plane_of_world[4], vec4 width, float texel,
                   float quantum, vec3 receiver, vec3 n, CascadeChoice choice, int taps) {
    if (choice.index < 0) {
        return 1.0;
    }
    const vec4 plane = vec4(n, -dot(n, receiver));
    float lit[2] = float[2](1.0, 1.0);
    for (int i = 0; i < (choice.blend > 0.0 ? 2 : 1); ++i) {
        const int layer = i == 0 ? choice.index : choice.next;
        if (layer >= 0) {
            const vec2 slope = receiver_depth_slope(plane_of_world[layer] * plane, 64.0);
            const float bias = receiver_depth_bias(slope, vec2(texel), quantum);
            lit[i] = cascade_pcf(maps, clip_of_world[layer] * vec4(receiver, 1.0), layer, slope, bias, width[layer], taps);
        }
    }
    return mix(lit[0], lit[1], choice.blend);
}

#endif
