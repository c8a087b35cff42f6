// Whether the light of surface_light.glsl arrives. One map a light, cascades for a directional one; every filter reads what
// shadow_pass drew (and moments.comp summed or averaged).

#if SHADOW != SHADOW_NONE
#if SHADOW >= SHADOW_PCF3 && SHADOW <= SHADOW_PCF7
#define PCF_TAPS (2 * SHADOW - 1)    // 3, 5, 7
#endif

#if SHADOW == SHADOW_LECTURE
#include "lib/lecture_shadow.glsl"
#elif CASCADES > 1 && SHADOW == SHADOW_HARD
#include "lib/cascades.glsl"
#include "lib/shadow_map.glsl"
#elif CASCADES > 1
#include "lib/pcf_cascades.glsl"
#elif SHADOW == SHADOW_HARD
#include "lib/shadow_map.glsl"
#elif SHADOW == SHADOW_PCSS
#include "lib/pcss.glsl"
#elif SHADOW == SHADOW_VSM || SHADOW == SHADOW_VSSM
#include "lib/vsm.glsl"
#else
#include "lib/pcf.glsl"
#include "lib/shadow_receiver.glsl"
#endif

#if CASCADES > 1
layout(std140, set = 0, binding = 5) uniform Cascades {
    mat4 cascade_view_projection[4];    // world to each layer's clip space
    mat4 cascade_plane_of_world[4];     // inverse transpose of those
    vec4 cascade_ends;                  // where each slice ends, view-space depth in metres, rising
    vec4 cascade_texel;                 // metres; side of a texel of each layer
    vec4 cascade_bias;                  // depth units; hard
    vec4 cascade_filter;                // uv; width of the filter's box in each layer; pcf
    float cascade_start;                // metres; where the first slice begins
    float cascade_band;                 // [0, 1]; share of a slice that blends into the next
    float cascade_texel_uv;             // uv; side of a texel
    float cascade_quantum;              // of the maps, depth units: 1 / 65535 for D16
};
layout(set = 0, binding = 6) uniform sampler2DArrayShadow cascade_maps;
#elif SHADOW == SHADOW_HARD && LIGHT_TYPE == LIGHT_POINT
layout(set = 0, binding = 4) uniform samplerCubeShadow shadow_cube;
#elif SHADOW == SHADOW_HARD || SHADOW == SHADOW_PCSS || SHADOW >= SHADOW_PCF3 && SHADOW <= SHADOW_PCF7
layout(set = 0, binding = 3) uniform sampler2DShadow shadow_map;
#endif

#if CASCADES == 1 && SHADOW != SHADOW_HARD && SHADOW != SHADOW_LECTURE
layout(std140, set = 0, binding = 7) uniform ShadowFilter {
    mat4 shadow_plane_of_world;    // world planes to the light's clip space: inverse transpose of shadow_view_projection
    float shadow_texel_uv;         // uv; side of a texel
    float shadow_filter;           // uv; width of the filter's box; pcf, vsm
    float shadow_quantum;          // of the map, depth units: 1 / 65535 for D16; pcf, pcss
    float light_size;              // metres, directional: 2 tan of half its angular diameter; pcss, vssm
    float shadow_extent;           // width of the map in metres, of a perspective one at 1 m; pcss, vssm
    float moments_far;             // metres, > 0, as shadow_pass has it; spot and point; vsm, vssm
    float moments_reference;       // [0, 1], as shadow_pass has it; vsm, vssm
    float moments_least;           // least variance, 1e-9 for centred moments; vsm, vssm
    float moments_bleeding;        // [0, 1), what is cut off of the dim end; vsm, vssm
    float moments_levels;          // of the mip chain; vsm
};
#endif

#if SHADOW == SHADOW_VSM && LIGHT_TYPE == LIGHT_POINT
layout(set = 0, binding = 9) uniform samplerCube shadow_moments_cube;
#elif SHADOW >= SHADOW_PCSS
// pcss and the lecture's form: depth, nearest; vsm: moments and their mips; vssm: their summed-area table.
layout(set = 0, binding = 8) uniform sampler2D shadow_values;
#endif
#endif

// 1 where the light arrives, 0 where something stands between. position: world; n, l: unit vectors.
float light_visibility(vec3 position, vec3 n, vec3 l) {
#if SHADOW == SHADOW_NONE
    return 1.0;
#elif SHADOW == SHADOW_LECTURE
    return shadow_factor_lecture(shadow_values, shadow_view_projection * vec4(position, 1.0));
#elif CASCADES > 1
    const float depth = (view_projection * vec4(position, 1.0)).w;
    const CascadeChoice choice = choose_cascade(depth, cascade_start, cascade_ends, CASCADES, cascade_band);
    const int own = max(choice.index, 0), next = max(choice.next, 0);
#if SHADOW == SHADOW_HARD
    // Each layer has an offset: what a fine layer's texels ask leaves the receiver in its own shadow in a coarser one.
    const vec3 in_own = offset_shadow_receiver(position, n, dot(n, l), cascade_texel[own]);
    const vec3 in_next = offset_shadow_receiver(position, n, dot(n, l), cascade_texel[next]);
    return cascaded_shadow(cascade_maps, cascade_view_projection[own] * vec4(in_own, 1.0),
                           cascade_view_projection[next] * vec4(in_next, 1.0), vec2(cascade_bias[own], cascade_bias[next]),
                           choice);
#else
    const vec4 receiver = vec4(position, 1.0), plane = vec4(n, -dot(n, position));
    return cascaded_pcf(cascade_maps, cascade_view_projection[own] * receiver, cascade_plane_of_world[own] * plane,
                        cascade_view_projection[next] * receiver, cascade_plane_of_world[next] * plane,
                        vec2(cascade_filter[own], cascade_filter[next]), cascade_texel_uv, cascade_quantum, choice, PCF_TAPS);
#endif
#elif LIGHT_TYPE == LIGHT_POINT && SHADOW == SHADOW_HARD
    const vec3 away = position - light_position;
    const float cosine = cube_axis_cosine(away, n, shadow_texel);
    const vec3 receiver = offset_shadow_receiver(position, n, cosine, shadow_texel * max_component(abs(away)));
    return shadow_factor_cube(shadow_cube, receiver - light_position, shadow_near, shadow_far, shadow_depth_bias);
#elif LIGHT_TYPE == LIGHT_POINT
    const vec3 from_light = position - light_position;
    const vec2 moments = textureLod(shadow_moments_cube, from_light, 0.0).xy;
    return vsm_factor(moments, max_component(abs(from_light)), moments_far, moments_reference, moments_least,
                      moments_bleeding);
#elif SHADOW == SHADOW_HARD
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    const float cosine = dot(n, l);    // the light's direction is the map's axis
    const float w = 1.0;
#else
    const float cosine = perspective_axis_cosine(shadow_view_projection, n);
    const float w = max((shadow_view_projection * vec4(position, 1.0)).w, 0.0);
#endif
    const vec3 receiver = offset_shadow_receiver(position, n, cosine, shadow_texel * w);
    return shadow_factor_2d(shadow_map, shadow_view_projection * vec4(receiver, 1.0), shadow_depth_bias);
#else
    const vec4 clip = shadow_view_projection * vec4(position, 1.0);
#if SHADOW == SHADOW_VSSM
    return vssm_factor(shadow_values, clip, light_size, shadow_near, shadow_far, shadow_extent, shadow_texel_uv,
                       moments_reference, moments_least, moments_bleeding);
#elif SHADOW == SHADOW_VSM
    const vec4 place = shadow_coordinates(clip);
    const vec2 moments = mip_average(shadow_values, place.xy, vec2(shadow_filter), moments_levels);
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    const float lit = vsm_factor(moments, place.z, 1.0, moments_reference, moments_least, moments_bleeding);
#else
    const float lit = vsm_factor(moments, clip.w, moments_far, moments_reference, moments_least, moments_bleeding);
#endif
    return place.w > 0.0 ? lit : 1.0;
#else
    const vec2 slope = receiver_depth_slope(shadow_plane_of_world * vec4(n, -dot(n, position)), 64.0);
    const float bias = receiver_depth_bias(slope, vec2(shadow_texel_uv), shadow_quantum);
#if SHADOW == SHADOW_PCSS && LIGHT_TYPE == LIGHT_DIRECTIONAL
    return pcss_factor_directional(shadow_values, shadow_map, clip, slope, bias, light_size, shadow_far, shadow_extent,
                                   shadow_texel_uv, vec2(0.0));
#elif SHADOW == SHADOW_PCSS
    return pcss_factor(shadow_values, shadow_map, clip, slope, bias, light_size, shadow_near, shadow_far, shadow_extent,
                       shadow_texel_uv, vec2(0.0));
#else
    const vec4 place = shadow_coordinates(clip);
    const float lit = pcf_box(shadow_map, place.xyz, slope, bias, vec2(shadow_filter), PCF_TAPS);
    return place.w > 0.0 ? lit : 1.0;
#endif
#endif
#endif
}
