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

// The chosen layers, blended. clip_of_world: each layer's matrix; bias: each layer's, depth units; receiver: world.
float cascaded_shadow(sampler2DArrayShadow maps, mat4 clip_of_world[4], vec4 bias, vec3 receiver, CascadeChoice choice) {
    if (choice.index < 0) {
        return 1.0;
    }
    const vec4 world = vec4(receiver, 1.0);
    float lit = cascade_factor(maps, clip_of_world[choice.index] * world, choice.index, bias[choice.index]);
    if (choice.blend > 0.0) {
        const int next = max(choice.next, 0);
        const float beyond = choice.next < 0 ? 1.0 : cascade_factor(maps, clip_of_world[next] * world, next, bias[next]);
        lit = mix(lit, beyond, choice.blend);
    }
    return lit;
}

#endif
