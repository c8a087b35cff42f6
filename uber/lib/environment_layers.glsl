#ifndef KILN_ENVIRONMENT_LAYERS_GLSL
#define KILN_ENVIRONMENT_LAYERS_GLSL
// Prefiltered environments in one array of cube maps: a layer for the sky, others for reflection probes, so that any number of
// them takes one texture.
#include "environment.glsl"

// sample_environment (environment.glsl) of one layer. layer: [0, layers); r: need not be of unit length; of length 0 it looks
// up; roughness: perceptual, limited to [0, 1] here; levels: >= 1.
vec3 sample_environment_layer(samplerCubeArray maps, int layer, vec3 r, float roughness, float levels) {
    const vec3 a = abs(r);
    const bool is_direction = max(max(a.x, a.y), a.z) > 1e-30;
    const vec3 towards = is_direction ? r : vec3(0.0, 1.0, 0.0);
    return textureLod(maps, vec4(towards, float(layer)), environment_lod(roughness, levels)).rgb;
}

#endif
