// The environment as a light: the sky, and reflection probes where the surface is in their boxes (baked by bake.comp).

#include "lib/environment_layers.glsl"
#include "lib/ibl.glsl"
#include "lib/sh.glsl"
#if REFLECTION != REFLECTION_NONE
#include "lib/probes.glsl"
#endif

layout(std140, set = 0, binding = 10) uniform Environment {
    vec4 sky_sh[9];              // rgb: L2 radiance coefficients of the sky, W/(m2 sr)
    float environment_levels;    // mips of environment_maps, the last one for roughness 1
    float split_sum_size;        // texels a side of split_sum_table
};
layout(set = 0, binding = 11) uniform samplerCubeArray environment_maps;    // prefiltered; layer 0 the sky, others probes
layout(set = 0, binding = 12) uniform sampler2D split_sum_table;            // rg: A, B; clamp, bilinear
#if REFLECTION != REFLECTION_NONE
layout(std140, set = 0, binding = 13) uniform Reflections {
    vec4 reflection_box_min[2];    // xyz: world; w: metres over which the probe fades in from its box's walls
    vec4 reflection_box_max[2];    // xyz: world
    vec4 reflection_centre[2];     // xyz: world, where the probe was taken
    ivec2 reflection_layer;        // of environment_maps
};
#endif

vec3 sky_irradiance(vec3 n) {
    return sh_irradiance_clamped(ShL2(vec3[9](sky_sh[0].rgb, sky_sh[1].rgb, sky_sh[2].rgb, sky_sh[3].rgb, sky_sh[4].rgb,
                                              sky_sh[5].rgb, sky_sh[6].rgb, sky_sh[7].rgb, sky_sh[8].rgb)),
                                 n);
}

// What the environment sends into a lobe around the mirror direction r. position: world; roughness: perceptual.
vec3 environment_radiance(vec3 position, vec3 r, float roughness) {
    vec3 radiance = sample_environment_layer(environment_maps, 0, r, roughness, environment_levels);
#if REFLECTION != REFLECTION_NONE
#if REFLECTION == REFLECTION_BLENDED
    const int probes = 2;
#else
    const int probes = 1;
#endif
    for (int i = 0; i < probes; ++i) {
        const vec3 low = reflection_box_min[i].xyz;
        const vec3 high = reflection_box_max[i].xyz;
        const vec3 towards = box_projected_direction(position, r, low, high, reflection_centre[i].xyz);
        const vec3 seen =
            sample_environment_layer(environment_maps, reflection_layer[i], towards, roughness, environment_levels);
        radiance = mix(radiance, seen, probe_box_weight(position, low, high, reflection_box_min[i].w));
    }
#endif
    return radiance;
}

// Diffuse and specular, with what is lost between microfacets put back. n, v: unit vectors; irradiance: on the surface.
vec3 environment_light(vec3 position, vec3 n, vec3 v, vec3 diffuse, vec3 specular, float roughness, vec3 irradiance) {
    const float n_dot_v = saturate(dot(n, v));
    const vec3 prefiltered = environment_radiance(position, environment_reflection(n, v), roughness);
    const vec2 ab = split_sum_lookup(split_sum_table, n_dot_v, roughness, split_sum_size);
    return image_based_light(diffuse, specular, irradiance / pi, prefiltered, ab);
}
