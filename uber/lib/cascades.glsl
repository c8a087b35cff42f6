#ifndef KILN_CASCADES_GLSL
#define KILN_CASCADES_GLSL
// Cascaded shadow maps of a directional light: the view's depth is split into up to four slices, each with a layer of its own
// in one depth array. Selected first and then sampled: one layer, two within a blend band, never all. Dimitrov, "Cascaded
// Shadow Maps", 2007; where to split: Zhang et al., "Parallel-Split Shadow Maps for Large-scale Virtual Environments", 2006;
// snapping to texels: Valient, "Stable Rendering of Cascaded Shadow Maps", ShaderX6, 2008 (reference/cascades.h).
//
// ends: where each slice ends, view-space depth in metres, rising; places past count are not read.
#include "math.glsl"
#include "shadow_receiver.glsl"

// The slice of a view-space depth. Slice i is [end of i - 1, end of i), the first reaches to the camera, the last is closed:
// every depth up to the last end has one slice. -1 beyond it, and for what is not a number. count: 1 to 4.
int cascade_index(float depth, vec4 ends, int count) {
    int index = 0;
    index += count > 1 && depth >= ends.x ? 1 : 0;
    index += count > 2 && depth >= ends.y ? 1 : 0;
    index += count > 3 && depth >= ends.z ? 1 : 0;
    return depth <= ends[count - 1] ? index : -1;
}

// Weight of the next slice: 0 up to end - band (end - start), then linear to 1 at the end, so that the sum of both is 1 and
// the shadow has no step at either end of the band. A band of 0 leaves a step at the end, and nothing to divide by.
// start, end: of the slice, metres; band: [0, 1].
float cascade_blend(float depth, float start, float end, float band) {
    const float width = band * (end - start);
    return saturate((depth - (end - width)) / max(width, 1e-6));
}

// Which layers to sample: index, and next with the weight blend. index -1: none, lit. next -1 with blend > 0: the last slice
// fades into light.
struct CascadeChoice {
    int index;
    int next;
    float blend;
};

// start: where the first slice begins, metres.
CascadeChoice choose_cascade(float depth, float start, vec4 ends, int count, float band) {
    CascadeChoice choice;
    choice.index = cascade_index(depth, ends, count);
    choice.next = -1;
    choice.blend = 0.0;
    if (choice.index >= 0) {
        const float slice_start = choice.index > 0 ? ends[max(choice.index - 1, 0)] : start;
        choice.blend = cascade_blend(depth, slice_start, ends[choice.index], band);
        choice.next = choice.index + 1 < count ? choice.index + 1 : -1;
    }
    return choice;
}

// 1 lit, 0 in shadow, in one layer. Zero gradients name the base level, so that it may stand in divergent code (an array has
// no textureLod with comparison in GLSL 4.50). clip: the receiver in that layer's clip space; bias: depth units.
float cascade_factor(sampler2DArrayShadow maps, vec4 clip, int layer, float bias) {
    const vec4 place = shadow_coordinates(clip);
    const float lit = textureGrad(maps, vec4(place.xy, float(layer), place.z - bias), vec2(0.0), vec2(0.0));
    return place.w > 0.0 ? lit : 1.0;
}

// The same from four comparisons of one gather, which names the base level by itself and ignores the filter: the texel that a
// nearest filter would have taken. Gathered from that texel's far corner, half a texel from where another footprint begins,
// so that rounding cannot choose other texels than the ones counted on.
float cascade_factor_gathered(sampler2DArrayShadow maps, vec4 clip, int layer, float bias) {
    const vec4 place = shadow_coordinates(clip);
    const vec2 size = vec2(textureSize(maps, 0).xy);
    const vec2 corner = (floor(place.xy * size) + 1.0) / size;
    const float lit = textureGather(maps, vec3(corner, float(layer)), place.z - bias).w;
    return place.w > 0.0 ? lit : 1.0;
}

// What a linear comparison filter gives, its weights in full precision: the four texels around the place.
float cascade_factor_gathered_linear(sampler2DArrayShadow maps, vec4 clip, int layer, float bias) {
    const vec4 place = shadow_coordinates(clip);
    const vec2 size = vec2(textureSize(maps, 0).xy);
    const vec2 at = place.xy * size - 0.5;
    const vec2 whole = floor(at);
    const vec4 lit = textureGather(maps, vec3((whole + 1.0) / size, float(layer)), place.z - bias);
    const vec2 along = mix(lit.wx, lit.zy, at.x - whole.x);
    return place.w > 0.0 ? mix(along.x, along.y, at.y - whole.y) : 1.0;
}

// The nearest texel by a fetch and a comparison of ours. maps: depth, without a comparison.
float cascade_factor_fetched(sampler2DArray maps, vec4 clip, int layer, float bias) {
    const vec4 place = shadow_coordinates(clip);
    const ivec2 size = textureSize(maps, 0).xy;
    const ivec2 texel = min(ivec2(place.xy * vec2(size)), size - 1);
    const float lit = place.z - bias <= texelFetch(maps, ivec3(texel, layer), 0).r ? 1.0 : 0.0;
    return place.w > 0.0 ? lit : 1.0;
}

// The chosen layers, blended. It is given places and not matrices, because GLSL passes an array by copying it: four matrices
// to choose from cost 48 ns on lavapipe, the look-up itself 2. The caller chooses where its matrices lie:
//     clip_of_world[max(choice.index, 0)] * vec4(receiver, 1.0), clip_of_world[max(choice.next, 0)] * vec4(receiver, 1.0)
// clip, next_clip: the receiver in the clip space of choice.index's layer and choice.next's, anything where that is -1; bias:
// of both, depth units.
float cascaded_shadow(sampler2DArrayShadow maps, vec4 clip, vec4 next_clip, vec2 bias, CascadeChoice choice) {
    if (choice.index < 0) {
        return 1.0;
    }
    float lit = cascade_factor(maps, clip, choice.index, bias.x);
    if (choice.blend > 0.0) {
        const float beyond = choice.next < 0 ? 1.0 : cascade_factor(maps, next_clip, choice.next, bias.y);
        lit = mix(lit, beyond, choice.blend);
    }
    return lit;
}

#endif
