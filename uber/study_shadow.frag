#version 450
// The shadow of one map on a receiver, by the filters that lib/ has: across the picture the place in the map, down the picture the
// receiver's distance from the lamp, so that a penumbra widens downwards. LECTURE is as printed in GAMES104 lecture 05.

#define FILTER_HARD 0
#define FILTER_PCF_3 1
#define FILTER_PCF_5 2
#define FILTER_PCF_7 3
#define FILTER_POISSON_16 4
#define FILTER_POISSON_32 5
#define FILTER_PCSS_SQUARE 6
#define FILTER_PCSS_DISK 7
#define FILTER_VSM 8
#define FILTER_VSSM 9
#define FILTER_VSSM_MIPS 10
#define FILTER_CASCADES 11
#define FILTER_LECTURE 12
#define FILTER_LECTURE_UNBIASED 13
#define FILTER_LECTURE_PCSS 14
#define FILTER_LECTURE_VARIANCE 15
#define FILTER_LECTURE_CASCADES 16

#if FILTER == FILTER_PCSS_DISK
#define PCSS_DISK_LIGHT 1
#endif
#include "lib/cascades.glsl"
#include "lib/pcf.glsl"
#include "lib/pcss.glsl"
#include "lib/shadow_map.glsl"
#include "lib/shadow_receiver.glsl"
#include "lib/vsm.glsl"
#include "lib/lecture_shadow.glsl"

layout(std140, set = 0, binding = 0) uniform Shadow {
    mat4 cascade_view_projection[4];    // of the world in which the receiver is (place on the screen in [-1, 1]^2, depth in the map)
    vec2 receiver_share;                // distance of the receiver over shadow_far in the first and the last row, (0, 1]
    float shadow_near;                  // of the map's perspective, metres, > 0
    float shadow_far;                   // held at or above twice shadow_near
    float shadow_extent;                // width of the map in metres at 1 m, > 0
    float light_width;                  // of the lamp, metres, >= 0
    float filter_width;                 // of pcf, poisson and vsm, uv, >= 0
    float map_texel;                    // side of a texel, uv
    float filter_turn;                  // of the Poisson disks, [0, 1)
    float moments_middle;               // reference of the moments, [0, 1]
    float moments_least;                // least variance, > 0
    float moments_bleeding;             // [0, 1)
    float moments_levels;               // of moment_map
    float cascade_end;                  // in depth of the first of two cascades, (0, 1); the second ends at 1
};
layout(set = 0, binding = 1) uniform sampler2DShadow shadow_map;         // LESS_OR_EQUAL
layout(set = 0, binding = 2) uniform sampler2D shadow_values;            // the same depths, nearest
layout(set = 0, binding = 3) uniform sampler2D moment_map;               // of distance, see vsm.glsl; trilinear
layout(set = 0, binding = 4) uniform sampler2D moment_sums;              // their summed-area table
layout(set = 0, binding = 5) uniform sampler2D depth_moments;            // lecture_variance: of depth and its square; trilinear
layout(set = 0, binding = 6) uniform sampler2DArrayShadow cascade_maps;  // two layers

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: the share of the light that arrives, [0, 1]; a: 1

float visibility() {
    const float near = shadow_near;
    const float far = max(shadow_far, 2.0 * near);
    const float distance = far * mix(receiver_share.x, receiver_share.y, screen_uv.y);
    const float depth = far * (distance - near) / (distance * (far - near));
    const vec2 ndc = screen_uv * 2.0 - 1.0;
    const vec4 clip = vec4(ndc * distance, depth * distance, distance);
    // The plane that touches the receiver: depth grows with the distance, the distance with v.
    const float rise = far * near / (distance * distance * (far - near)) * far * (receiver_share.y - receiver_share.x);
    const vec2 slope = vec2(0.0, clamp(rise, -64.0, 64.0));
    const float bias = receiver_depth_bias(slope, vec2(map_texel), 1.1920929e-7);

#if FILTER == FILTER_CASCADES || FILTER == FILTER_LECTURE_CASCADES
    const vec3 receiver = vec3(ndc, depth);
#if FILTER == FILTER_CASCADES
    const CascadeChoice choice = choose_cascade(depth, 0.0, vec4(cascade_end, 1.0, 1.0, 1.0), 2, 0.0);
    const int own = max(choice.index, 0), next = max(choice.next, 0);
    return cascaded_shadow(cascade_maps, cascade_view_projection[own] * vec4(receiver, 1.0),
                           cascade_view_projection[next] * vec4(receiver, 1.0), vec2(0.0), choice);
#else
    return cascaded_shadow_lecture(cascade_maps, cascade_view_projection, receiver, 2, depth < cascade_end ? 0 : 1);
#endif
#elif FILTER == FILTER_LECTURE
    return shadow_factor_lecture(shadow_values, clip);
#elif FILTER == FILTER_LECTURE_UNBIASED
    return shadow_factor_unbiased_lecture(shadow_values, clip);
#elif FILTER == FILTER_HARD
    return shadow_factor_2d(shadow_map, clip, bias);
#elif FILTER == FILTER_PCSS_SQUARE || FILTER == FILTER_PCSS_DISK
    return pcss_factor(shadow_values, shadow_map, clip, slope, bias, light_width, near, far, shadow_extent, map_texel, vec2(0.0));
#elif FILTER == FILTER_VSSM
    return vssm_factor(moment_sums, clip, light_width, near, far, shadow_extent, map_texel, moments_middle, moments_least,
                       moments_bleeding);
#elif FILTER == FILTER_VSSM_MIPS
    return vssm_factor_mips(moment_map, moments_levels, clip, light_width, near, far, shadow_extent, map_texel, moments_middle,
                            moments_least, moments_bleeding);
#else
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
#if FILTER == FILTER_PCF_3
    return pcf_3(shadow_map, place.xyz, slope, bias, vec2(filter_width));
#elif FILTER == FILTER_PCF_5
    return pcf_5(shadow_map, place.xyz, slope, bias, vec2(filter_width));
#elif FILTER == FILTER_PCF_7
    return pcf_7(shadow_map, place.xyz, slope, bias, vec2(filter_width));
#elif FILTER == FILTER_POISSON_16
    return pcf_poisson_16(shadow_map, place.xyz, slope, bias, vec2(0.5 * filter_width), filter_turn);
#elif FILTER == FILTER_POISSON_32
    return pcf_poisson_32(shadow_map, place.xyz, slope, bias, vec2(0.5 * filter_width), filter_turn);
#elif FILTER == FILTER_VSM
    return vsm_factor(mip_average(moment_map, place.xy, vec2(filter_width), moments_levels), distance, far, moments_middle,
                      moments_least, moments_bleeding);
#elif FILTER == FILTER_LECTURE_PCSS
    const float search = max(pcss_search_width(distance, near, light_width) / (shadow_extent * near), map_texel);
    const vec2 met = pcss_blockers(shadow_values, place.xyz, slope, bias, vec2(search), near, far, vec2(0.0));
    const float blocker = pcss_mean_blocker_lecture(met.x * met.y, met.y);
    const float width = pcss_penumbra_width_lecture(distance, blocker, light_width) / (shadow_extent * distance);
    return pcss_filter(shadow_map, place.xyz, slope, bias, vec2(width), vec2(0.0));
#else
    return chebyshev_lecture(mip_average(depth_moments, place.xy, vec2(filter_width), moments_levels), place.z);
#endif
#endif
}

void main() {
    color = vec4(vec3(visibility()), 1.0);
}
