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

// A layer's own share of cascaded_pcf: 1 for layer -1. plane: the receiver's, in the layer's clip space.
float cascade_pcf_layer(sampler2DArrayShadow maps, vec4 clip, vec4 plane, int layer, float width, float texel, float quantum,
                        int taps) {
    if (layer < 0) {
        return 1.0;
    }
    const vec2 slope = receiver_depth_slope(plane, 64.0);
    return cascade_pcf(maps, clip, layer, slope, receiver_depth_bias(slope, vec2(texel), quantum), width, taps);
}

// The chosen layers, filtered and blended, given places as cascaded_shadow is. clip, next_clip: the receiver in the clip space
// of choice.index's layer and of choice.next's; plane, next_plane: its plane there, world plane times the inverse transpose of
// the matrix; any four where the index is -1. width: of the box in both, uv; texel: side of a texel, uv; quantum: of the map,
// depth units (shadow_receiver.glsl). taps: a side, 1 to 16.
float cascaded_pcf(sampler2DArrayShadow maps, vec4 clip, vec4 plane, vec4 next_clip, vec4 next_plane, vec2 width, float texel,
                   float quantum, CascadeChoice choice, int taps) {
    if (choice.index < 0) {
        return 1.0;
    }
    float lit = cascade_pcf_layer(maps, clip, plane, choice.index, width.x, texel, quantum, taps);
    if (choice.blend > 0.0) {
        const float beyond = cascade_pcf_layer(maps, next_clip, next_plane, choice.next, width.y, texel, quantum, taps);
        lit = mix(lit, beyond, choice.blend);
    }
    return lit;
}

#endif
