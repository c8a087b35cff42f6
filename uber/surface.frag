#version 450
// Fragment stage of surface: one opaque surface under one light in one pass.
//
// The text is arranged by what a pass needs, so that an axis that a pass ignores is never read in it: depth and velocity
// have one text each, the g-buffer one a material, lightmap and sidedness, and only the forward pass looks at lights.
// Formulas live in lib/, each with its range, unit and source.

#include "surface_axes.glsl"
#include "surface_interface.glsl"

#if PASS == PASS_DEPTH

void main() {}

#elif PASS == PASS_VELOCITY

#include "lib/motion.glsl"

layout(location = 4) in vec4 clip_position;
layout(location = 5) in vec4 previous_clip_position;
layout(location = 0) out vec2 motion;

void main() {
    motion = screen_motion(clip_position, previous_clip_position, jitter);
}

#else

#include "lib/math.glsl"
#include "lib/vectors.glsl"
#include "lib/materials.glsl"
// The rest only where it is called: a system's text then belongs to its own variants, and editing it recompiles no others.
#if MATERIAL == MATERIAL_BLINN_PHONG
#include "lib/blinn_phong.glsl"
#elif PASS == PASS_FORWARD && LIGHT_TYPE != LIGHT_NONE
#include "lib/cook_torrance.glsl"
#endif
#if LIGHTMAP == LIGHTMAP_SH_LQ || LIGHTMAP == LIGHTMAP_SH_HQ
#include "lib/sh_lightmap.glsl"
#endif
#if PASS == PASS_GBUFFER
#include "lib/octahedral.glsl"
#elif LIGHT_TYPE == LIGHT_POINT || LIGHT_TYPE == LIGHT_SPOT
#include "lib/lights.glsl"
#endif
#if SHADOW == SHADOW_HARD
#include "lib/shadow_map.glsl"
#endif

layout(set = 1, binding = 1) uniform sampler2D base_map;         // sRGB; diffuse, for pbr_mr base colour
layout(set = 1, binding = 2) uniform sampler2D specular_map;     // sRGB; blinn_phong: ks, pbr_sg: F0
layout(set = 1, binding = 3) uniform sampler2D gloss_map;        // linear r; pbr_sg
layout(set = 1, binding = 4) uniform sampler2D roughness_map;    // linear r; pbr_mr
layout(set = 1, binding = 5) uniform sampler2D metallic_map;     // linear r; pbr_mr

layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec2 material_uv;

#if LIGHTMAP != LIGHTMAP_NONE
layout(location = 3) in vec2 atlas_uv;
layout(set = 2, binding = 1) uniform sampler2D lightmap_flat;    // irradiance / lightmap_range
layout(set = 2, binding = 2) uniform sampler2D lightmap_l0;      // BC6H: m0 / lightmap_range
layout(set = 2, binding = 3) uniform sampler2D lightmap_l1_y;    // BC7 or BC1: 0.5 + 0.5 m1 / m0, one map a
layout(set = 2, binding = 4) uniform sampler2D lightmap_l1_z;    // coefficient, one channel a colour
layout(set = 2, binding = 5) uniform sampler2D lightmap_l1_x;
#endif

// What the BRDFs and the g-buffer take, sampled once.
struct Shading {
    vec3 diffuse;       // [0, 1]
    vec3 specular;      // F0, for Blinn-Phong ks; [0, 1]
    float roughness;    // perceptual, [0, 1]
};

Shading sample_material() {
    Shading s;
    const vec3 base = reflectance(texture(base_map, material_uv).rgb, base_factor.rgb);
#if MATERIAL == MATERIAL_PBR_MR
    const float metallic = texture(metallic_map, material_uv).r * metallic_factor;
    s.diffuse = metallic_diffuse(base, metallic);
    s.specular = metallic_f0(base, metallic, dielectric_specular);
    s.roughness = saturate(texture(roughness_map, material_uv).r * roughness_factor);
#else
    s.diffuse = base;
    s.specular = reflectance(texture(specular_map, material_uv).rgb, specular_factor.rgb);
#if MATERIAL == MATERIAL_PBR_SG
    s.roughness = 1.0 - saturate(texture(gloss_map, material_uv).r * glossiness_factor);
#else
    s.roughness = blinn_phong_roughness(clamp(shininess, 1.0, 2048.0));
#endif
#endif
    return s;
}

// Light that reached the surface by way of others, as irradiance.
vec3 indirect_irradiance(vec3 n) {
#if LIGHTMAP == LIGHTMAP_NONE
    return ambient_irradiance;
#elif LIGHTMAP == LIGHTMAP_FLAT
    return texture(lightmap_flat, atlas_uv).rgb * lightmap_range;
#else
    // High and low quality are two compressions of the same coefficients (BC7 or BC1) and share this text.
    return sh_l1_irradiance(texture(lightmap_l0, atlas_uv).rgb * lightmap_range,
                            decode_sh_ratio(texture(lightmap_l1_y, atlas_uv).rgb),
                            decode_sh_ratio(texture(lightmap_l1_z, atlas_uv).rgb),
                            decode_sh_ratio(texture(lightmap_l1_x, atlas_uv).rgb), n);
#endif
}

vec3 shading_normal() {
    const vec3 n = safe_normalize(world_normal, vec3(0.0, 0.0, 1.0));
#if TWO_SIDED
    return gl_FrontFacing ? n : -n;
#else
    return n;
#endif
}

#if PASS == PASS_GBUFFER

#if MATERIAL == MATERIAL_BLINN_PHONG
const float shading_model = 0.0;
#else
const float shading_model = 1.0;
#endif

layout(location = 0) out vec4 gbuffer_diffuse;     // rgb: diffuse reflectance; a: 0 Blinn-Phong, 1 GGX
layout(location = 1) out vec4 gbuffer_specular;    // rgb: F0 or ks; a: perceptual roughness
layout(location = 2) out vec2 gbuffer_normal;      // octahedral, [-1, 1]
layout(location = 3) out vec4 gbuffer_radiance;    // rgb: what needs no light: indirect diffuse and emission

void main() {
    const vec3 n = shading_normal();
    const Shading s = sample_material();
    gbuffer_diffuse = vec4(s.diffuse, shading_model);
    gbuffer_specular = vec4(s.specular, s.roughness);
    gbuffer_normal = encode_octahedral(n);
    gbuffer_radiance = vec4(s.diffuse / pi * indirect_irradiance(n) + emissive, 1.0);
}

#else

#if SHADOW == SHADOW_HARD
#if LIGHT_TYPE == LIGHT_POINT
layout(set = 0, binding = 4) uniform samplerCubeShadow shadow_cube;
#else
layout(set = 0, binding = 3) uniform sampler2DShadow shadow_map;
#endif
#endif

layout(location = 0) out vec4 color;    // rgb: scene radiance, linear; a: 1

#if LIGHT_TYPE != LIGHT_NONE

// Unit vector towards the light.
vec3 direction_to_light() {
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    return safe_normalize(-light_direction, vec3(0.0, 1.0, 0.0));
#else
    return safe_normalize(light_position - world_position, vec3(0.0, 1.0, 0.0));
#endif
}

// Irradiance on a plane that faces the light, without shadows.
vec3 light_irradiance(vec3 l) {
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    return light_intensity;
#else
    const vec3 to_light = light_position - world_position;
    float attenuation = distance_attenuation(dot(to_light, to_light), light_range);
#if LIGHT_TYPE == LIGHT_SPOT
    attenuation *= cone_attenuation(dot(-l, light_direction), light_cos_inner, light_cos_outer);
#endif
    return light_intensity * attenuation;
#endif
}

// 1 where the light arrives, 0 where something stands between.
float light_visibility(vec3 n, vec3 l) {
#if SHADOW == SHADOW_NONE
    return 1.0;
#elif LIGHT_TYPE == LIGHT_POINT
    const vec3 away = abs(world_position - light_position);
    const float texel = shadow_texel * max_component(away);
    const vec3 receiver = offset_shadow_receiver(world_position, n, dot(n, l), texel);
    return shadow_factor_cube(shadow_cube, receiver - light_position, shadow_near, shadow_far, shadow_depth_bias);
#else
    const float w = (shadow_view_projection * vec4(world_position, 1.0)).w;
    const vec3 receiver = offset_shadow_receiver(world_position, n, dot(n, l), shadow_texel * max(w, 0.0));
    return shadow_factor_2d(shadow_map, shadow_view_projection * vec4(receiver, 1.0), shadow_depth_bias);
#endif
}

#endif

void main() {
    const vec3 n = shading_normal();
    const Shading s = sample_material();
    vec3 radiance = s.diffuse / pi * indirect_irradiance(n) + emissive;

#if LIGHT_TYPE != LIGHT_NONE
    const vec3 v = safe_normalize(camera_position - world_position, n);
    const vec3 l = direction_to_light();
#if MATERIAL == MATERIAL_BLINN_PHONG
    const vec3 reflected = blinn_phong(n, v, l, s.diffuse, s.specular, shininess);
#else
    const vec3 reflected = cook_torrance(n, v, l, s.diffuse, s.specular, s.roughness);
#endif
    radiance += reflected * light_irradiance(l) * light_visibility(n, l);
#endif

    color = vec4(radiance, 1.0);
}

#endif
#endif
