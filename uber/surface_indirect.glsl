// Light that reached the surface by way of others: lightmap, probes or the sky for the diffuse part; the sky and reflection
// probes for the specular part.

#if LIGHTMAP == LIGHTMAP_SH_LQ || LIGHTMAP == LIGHTMAP_SH_HQ
#include "lib/sh_lightmap.glsl"
#elif LIGHTMAP == LIGHTMAP_SH_LECTURE
#include "lib/lecture_sh.glsl"
#include "lib/sh_lightmap.glsl"
#endif
#if PROBES != PROBES_NONE
#include "lib/probes.glsl"
#endif

#if LIGHTMAP != LIGHTMAP_NONE
layout(location = 3) in vec2 atlas_uv;
layout(set = 2, binding = 1) uniform sampler2D lightmap_flat;    // irradiance / lightmap_range
layout(set = 2, binding = 2) uniform sampler2D lightmap_l0;      // BC6H: m0 / lightmap_range
layout(set = 2, binding = 3) uniform sampler2D lightmap_l1_y;    // BC7 or BC1: 0.5 + 0.5 m1 / m0, one map a
layout(set = 2, binding = 4) uniform sampler2D lightmap_l1_z;    // coefficient, one channel a colour
layout(set = 2, binding = 5) uniform sampler2D lightmap_l1_x;
#endif

#if PROBES != PROBES_NONE
// A window of the level's grid around the object, x running fastest.
layout(std140, set = 2, binding = 6) uniform Probes {
    vec3 probe_first;              // world; place of the first
    vec3 probe_inverse_spacing;    // 1 / metres
    ivec3 probe_count;             // an axis, >= 1; the product is at most 64
    vec4 probe_sh[576];            // rgb; nine a probe: sh_l2 radiance coefficients, or moments m0, m1_y, m1_z, m1_x and 5 unused
};

// Where the coefficients of a corner of a cell begin.
int probe_place(ivec3 corner) {
    const ivec3 p = clamp(corner, ivec3(0), probe_count - 1);
    return 9 * clamp((p.z * probe_count.y + p.y) * probe_count.x + p.x, 0, 63);
}

vec3 probe_irradiance(vec3 position, vec3 n) {
    const GridCell at = probe_grid_cell(position - probe_first, probe_inverse_spacing, probe_count);
    const TrilinearWeights weights = trilinear_weights(at.t);
#if PROBES == PROBES_SH_L1
    ShMomentsL1 sum = sh_moments_zero();
#else
    ShL2 sum = sh_l2_zero();
#endif
    for (int i = 0; i < 8; ++i) {
        const int first = probe_place(at.cell + ivec3(i & 1, i >> 1 & 1, i >> 2));
        const float weight = i < 4 ? weights.low[i] : weights.high[i - 4];
#if PROBES == PROBES_SH_L1
        sum = sh_add(sum,
                     ShMomentsL1(probe_sh[first].rgb, probe_sh[first + 1].rgb, probe_sh[first + 2].rgb, probe_sh[first + 3].rgb),
                     weight);
#else
        for (int k = 0; k < 9; ++k) {
            sum.c[k] += weight * probe_sh[first + k].rgb;
        }
#endif
    }
    return sh_irradiance_clamped(sum, n);
}
#endif

#if IBL == IBL_SPLIT_SUM
#include "surface_environment.glsl"
#endif

// On a receiver with normal n. position: world.
MEDIUM vec3 indirect_irradiance(vec3 position, vec3 n) {
#if LIGHTMAP == LIGHTMAP_FLAT
    return texture(lightmap_flat, atlas_uv).rgb * lightmap_range;
#elif LIGHTMAP == LIGHTMAP_SH_LECTURE
    // The stored moments read as if they were coefficients of the basis.
    const vec3 m0 = texture(lightmap_l0, atlas_uv).rgb * lightmap_range;
    const vec3 m1_y = m0 * decode_sh_ratio(texture(lightmap_l1_y, atlas_uv).rgb);
    const vec3 m1_z = m0 * decode_sh_ratio(texture(lightmap_l1_z, atlas_uv).rgb);
    const vec3 m1_x = m0 * decode_sh_ratio(texture(lightmap_l1_x, atlas_uv).rgb);
    return vec3(sh_irradiance_lecture(vec4(m0.r, m1_y.r, m1_z.r, m1_x.r), n),
                sh_irradiance_lecture(vec4(m0.g, m1_y.g, m1_z.g, m1_x.g), n),
                sh_irradiance_lecture(vec4(m0.b, m1_y.b, m1_z.b, m1_x.b), n));
#elif LIGHTMAP != LIGHTMAP_NONE
    // High and low quality are two compressions of the same coefficients (BC7 or BC1) and share this text.
    return sh_l1_irradiance(texture(lightmap_l0, atlas_uv).rgb * lightmap_range,
                            decode_sh_ratio(texture(lightmap_l1_y, atlas_uv).rgb),
                            decode_sh_ratio(texture(lightmap_l1_z, atlas_uv).rgb),
                            decode_sh_ratio(texture(lightmap_l1_x, atlas_uv).rgb), n);
#elif PROBES != PROBES_NONE
    return probe_irradiance(position, n);
#elif IBL == IBL_SPLIT_SUM
    return sky_irradiance(n);
#else
    return ambient_irradiance;
#endif
}
