#version 450
// Image-based light on a sphere, by the forms that lib/ has. The first value of every axis is the form that surface takes; LECTURE is
// as printed in GAMES104 lecture 05. manifests/library.yaml says what goes together.

#define REFLECTION_PREFILTERED 0
#define REFLECTION_PLAIN_MIPS 1
#define REFLECTION_EQUIRECT 2
#define REFLECTION_BOX 3
#define REFLECTION_NORMALISED 4
#define REFLECTION_LECTURE_DIRECTION 5
#define REFLECTION_LECTURE_LEVEL 6

#define SPLIT_SUM_TABLE 0
#define SPLIT_SUM_FIT 1
#define SPLIT_SUM_SAMPLED 2
#define SPLIT_SUM_SAMPLED_KARIS 3
#define SPLIT_SUM_LECTURE 4

#define SCATTER_MULTIPLE 0
#define SCATTER_SCALED 1
#define SCATTER_SINGLE 2

#include "lib/environment.glsl"
#include "lib/ggx.glsl"
#include "lib/ibl.glsl"
#include "lib/math.glsl"
#include "study_sphere.glsl"
#if REFLECTION == REFLECTION_BOX || REFLECTION == REFLECTION_NORMALISED
#include "lib/probes.glsl"
#elif REFLECTION == REFLECTION_LECTURE_DIRECTION || REFLECTION == REFLECTION_LECTURE_LEVEL
#include "lib/lecture_environment.glsl"
#endif
#if SPLIT_SUM == SPLIT_SUM_LECTURE
#include "lib/lecture_ibl.glsl"
#elif SPLIT_SUM == SPLIT_SUM_SAMPLED || SPLIT_SUM == SPLIT_SUM_SAMPLED_KARIS
#include "lib/ibl_bake.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Environment {
    vec3 diffuse_albedo;         // of the base, [0, 1], 0 for a metal
    float roughness;             // perceptual, [0, 1]
    vec3 f0;                     // [0, 1]
    float environment_levels;    // of environment_map and plain_map, >= 1
    vec3 box_extent;             // box: half sides of the room about the sphere's centre, where the probe stands; > 1 holds the sphere
    float split_sum_size;        // texels a side of split_sum_table, >= 2
    vec3 probe_irradiance;       // normalised: at the reflection probe
    float brightest;             // normalised: limit of the ratio
};
layout(set = 0, binding = 1) uniform samplerCube environment_map;    // prefiltered, level i for roughness i / (levels - 1)
layout(set = 0, binding = 2) uniform samplerCube plain_map;          // the same sky, each level the mean of four texels
layout(set = 0, binding = 3) uniform samplerCube irradiance_map;     // E / pi
layout(set = 0, binding = 4) uniform sampler2D split_sum_table;
layout(set = 0, binding = 5) uniform sampler2D sky_picture;          // equirectangular, prefiltered like environment_map

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: scene radiance, linear; a: 1

// Of the environment as the lobe about the mirror direction blurs it.
vec3 reflected(vec3 n, vec3 v, vec3 irradiance_over_pi) {
#if REFLECTION == REFLECTION_LECTURE_DIRECTION
    const vec3 r = environment_reflection_lecture(n, v);
#else
    const vec3 r = environment_reflection(n, v);
#endif
#if REFLECTION == REFLECTION_PLAIN_MIPS
    return sample_environment(plain_map, r, roughness, environment_levels);
#elif REFLECTION == REFLECTION_EQUIRECT
    return sample_equirect(sky_picture, r, environment_lod(roughness, environment_levels));
#elif REFLECTION == REFLECTION_BOX
    return sample_environment(environment_map, box_projected_direction(n, r, -box_extent, box_extent, vec3(0.0)), roughness,
                              environment_levels);
#elif REFLECTION == REFLECTION_NORMALISED
    return probe_normalized_reflection(sample_environment(environment_map, r, roughness, environment_levels),
                                       pi * irradiance_over_pi, probe_irradiance, brightest);
#elif REFLECTION == REFLECTION_LECTURE_LEVEL
    return sample_environment_lecture(plain_map, r);
#else
    return sample_environment(environment_map, r, roughness, environment_levels);
#endif
}

vec2 split_sum(float n_dot_v) {
#if SPLIT_SUM == SPLIT_SUM_FIT
    return split_sum_fit(n_dot_v, roughness);
#elif SPLIT_SUM == SPLIT_SUM_SAMPLED
    return split_sum_sampled(n_dot_v, ggx_alpha(roughness), 16u);
#elif SPLIT_SUM == SPLIT_SUM_SAMPLED_KARIS
    return split_sum_sampled_karis(n_dot_v, ggx_alpha(roughness), 16u);
#elif SPLIT_SUM == SPLIT_SUM_LECTURE
    return split_sum_sampled_lecture(n_dot_v, ggx_alpha(roughness), 16u);
#else
    return split_sum_lookup(split_sum_table, n_dot_v, roughness, split_sum_size);
#endif
}

void main() {
    const vec3 n = sphere_normal(screen_uv);
    const vec3 irradiance_over_pi = sample_environment(irradiance_map, n, 0.0, 1.0);
    const vec3 prefiltered = reflected(n, sphere_viewer, irradiance_over_pi);
    const vec2 ab = split_sum(n.z);
#if SCATTER == SCATTER_SINGLE
    const vec3 radiance = diffuse_albedo * irradiance_over_pi + environment_specular(prefiltered, f0, ab);
#elif SCATTER == SCATTER_SCALED
    const vec3 radiance = diffuse_albedo * irradiance_over_pi + environment_specular_multiscatter(prefiltered, f0, ab);
#else
    const vec3 radiance = image_based_light(diffuse_albedo, f0, irradiance_over_pi, prefiltered, ab);
#endif
    color = vec4(on_sphere(screen_uv) ? radiance : vec3(0.0), 1.0);
}
