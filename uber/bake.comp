#version 450
// Bakes what image-based light is shaded with: the tables of lib/ibl.glsl, spherical harmonics, probes, and the split of a
// sun from its sky. One image or one buffer a variant; the environment is a cube map with box-filtered mips.
//
// A sun must leave before mips are made: one texel above 65504 is infinite in fp16 and in every mip above it. WHAT_SUN
// writes the map without what exceeds `limit`, and what that was, as an analytic light.

#define WHAT_IRRADIANCE 0
#define WHAT_PREFILTER 1
#define WHAT_SPLIT_SUM 2
#define WHAT_SH_L1 3
#define WHAT_SH_L2 4
#define WHAT_PROBE 5
#define WHAT_SUN 6

#define SAMPLING_FILTERED 0
#define SAMPLING_PLAIN 1
#define SAMPLING_TEXELS 2

#define SMITH_HEIGHT_CORRELATED 0
#define SMITH_KARIS 1
#define SMITH_LECTURE 2

layout(push_constant) uniform Bake {
    float roughness;    // prefilter: perceptual, [0, 1]
    uint samples;       // [1, 65536]
    int level;          // of the environment, where all its texels are summed
    float limit;        // sun: radiance that the map may keep, at most 65504
};

#if WHAT == WHAT_SPLIT_SUM

#if SMITH == SMITH_LECTURE
#include "lib/lecture_ibl.glsl"
#else
#include "lib/ibl_bake.glsl"
#endif
#include "lib/ibl.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 3, rgba16f) uniform writeonly image2D table;    // rg: A, B; x is n.v, y is roughness

void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    const int size = imageSize(table).x;
    if (any(greaterThanEqual(place, imageSize(table)))) {
        return;
    }
    const vec2 p = split_sum_texel(place, max(size, 2));
#if SMITH == SMITH_HEIGHT_CORRELATED
    const vec2 ab = split_sum_sampled(p.x, ggx_alpha(p.y), samples);
#elif SMITH == SMITH_KARIS
    const vec2 ab = split_sum_sampled_karis(p.x, ggx_alpha(p.y), samples);
#else
    const vec2 ab = split_sum_sampled_lecture(p.x, ggx_alpha(p.y), samples);
#endif
    imageStore(table, place, vec4(ab, 0.0, 1.0));
}

#elif WHAT == WHAT_IRRADIANCE || WHAT == WHAT_PREFILTER

#include "lib/ibl_bake.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform samplerCube environment;
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2DArray target;    // a layer a face; rgb: E / pi, or radiance

void main() {
    const ivec3 place = ivec3(gl_GlobalInvocationID);
    const ivec3 size = imageSize(target);
    if (any(greaterThanEqual(place, size)) || place.z >= 6) {
        return;
    }
    const vec3 n = normalize(cube_direction(place.z, cube_texel_centre(place.xy, size.x)));
    const int read = clamp(level, 0, textureQueryLevels(environment) - 1);
#if WHAT == WHAT_IRRADIANCE
#if SAMPLING == SAMPLING_TEXELS
    const vec3 baked = irradiance_summed(environment, n, read);
#else
    const vec3 baked = irradiance_sampled(environment, n, samples, SAMPLING == SAMPLING_FILTERED);
#endif
#else
#if SAMPLING == SAMPLING_TEXELS
    const vec3 baked = prefilter_summed(environment, n, ggx_alpha(roughness), read);
#else
    const vec3 baked = prefilter_sampled(environment, n, ggx_alpha(roughness), samples, SAMPLING == SAMPLING_FILTERED);
#endif
#endif
    imageStore(target, place, vec4(min(baked, vec3(65504.0)), 1.0));
}

#else

#include "lib/environment.glsl"
#include "lib/sh.glsl"

// One work group sums a whole map; one group a probe where there are several.
#define LANES 64
layout(local_size_x = LANES) in;

#if WHAT == WHAT_PROBE
layout(set = 0, binding = 4) uniform samplerCubeArray probes;
#else
layout(set = 0, binding = 0) uniform samplerCube environment;
#endif
// sh_l1, sh_l2: orthonormal coefficients of radiance, 4 or 9; probe: raw moments m0, m1_y, m1_z, m1_x, 4 a probe;
// sun: rgb irradiance at normal incidence of what was cut, then its direction and share of a point (1: all from there).
layout(set = 0, binding = 2, std430) writeonly buffer Result {
    vec4 result[];
};

#if WHAT == WHAT_SH_L2
#define SUMS 9
#elif WHAT == WHAT_SUN
#define SUMS 2
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2DArray target;    // the map without the sun, a layer a face
#else
#define SUMS 4
#endif
shared vec3 partial[SUMS * LANES];

vec3 radiance_at(vec3 d, int read) {
#if WHAT == WHAT_PROBE
    return textureLod(probes, vec4(d, float(gl_WorkGroupID.x)), float(read)).rgb;
#else
    return textureLod(environment, d, float(read)).rgb;
#endif
}

void main() {
#if WHAT == WHAT_PROBE
    const int read = clamp(level, 0, textureQueryLevels(probes) - 1);
    const int size = textureSize(probes, read).x;
#elif WHAT == WHAT_SUN
    const int read = 0;
    const int size = textureSize(environment, 0).x;
#else
    const int read = clamp(level, 0, textureQueryLevels(environment) - 1);
    const int size = textureSize(environment, read).x;
#endif
    const int lane = int(gl_LocalInvocationID.x);
#if WHAT == WHAT_SH_L2
    ShL2 sum = sh_l2_zero();
#elif WHAT == WHAT_SH_L1
    ShL1 sum = sh_l1_zero();
#elif WHAT == WHAT_PROBE
    ShMomentsL1 sum = sh_moments_zero();
#else
    vec3 cut = vec3(0.0);
    vec3 towards = vec3(0.0);
#endif
    for (int i = lane; i < 6 * size * size; i += LANES) {
        const ivec2 texel = ivec2(i % size, i / size % size);
        const int face = i / (size * size);
        const vec2 p = cube_texel_centre(texel, size);
        const vec3 d = normalize(cube_direction(face, p));
        const vec3 radiance = radiance_at(d, read);
        const float solid_angle = cube_texel_solid_angle(p, float(size));
#if WHAT == WHAT_SH_L2
        sum = sh_l2_accumulate(sum, d, radiance, solid_angle);
#elif WHAT == WHAT_SH_L1
        sum = sh_l1_accumulate(sum, d, radiance, solid_angle);
#elif WHAT == WHAT_PROBE
        sum = sh_moments_accumulate(sum, d, radiance, solid_angle);
#else
        const float most = clamp(limit, 0.0, 65504.0);
        const vec3 excess = environment_excess(radiance, most) * solid_angle;
        cut += excess;
        towards += dot(excess, vec3(0.2126, 0.7152, 0.0722)) * d;
        imageStore(target, ivec3(texel, face), vec4(environment_clamped(radiance, most), 1.0));
#endif
    }
#if WHAT == WHAT_SUN
    partial[lane] = cut;
    partial[LANES + lane] = towards;
#elif WHAT == WHAT_PROBE
    partial[lane] = sum.m0;
    partial[LANES + lane] = sum.m1_y;
    partial[2 * LANES + lane] = sum.m1_z;
    partial[3 * LANES + lane] = sum.m1_x;
#else
    for (int k = 0; k < SUMS; ++k) {
        partial[k * LANES + lane] = sum.c[k];
    }
#endif
    // Halving in a fixed order, so that equal maps give equal sums.
    for (int half_lanes = LANES / 2; half_lanes > 0; half_lanes /= 2) {
        barrier();
        if (lane < half_lanes) {
            for (int k = 0; k < SUMS; ++k) {
                partial[k * LANES + lane] += partial[k * LANES + lane + half_lanes];
            }
        }
    }
    barrier();
    if (lane == 0) {
        const int first = SUMS * int(gl_WorkGroupID.x);
#if WHAT == WHAT_SUN
        const vec3 direction = partial[LANES];
        const float together = length(direction);
        const float alone = dot(partial[0], vec3(0.2126, 0.7152, 0.0722));
        result[first] = vec4(partial[0], 0.0);
        result[first + 1] = together > 0.0 ? vec4(direction / together, together / max(alone, 1e-30)) : vec4(0.0, 1.0, 0.0, 0.0);
#else
        for (int k = 0; k < SUMS; ++k) {
            result[first + k] = vec4(partial[k * LANES], 0.0);
        }
#endif
    }
}

#endif
