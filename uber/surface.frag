#version 450
// Fragment stage of surface: one opaque surface under one light in one pass.
//
// The text is arranged by what a pass needs, so that an axis that a pass ignores is never read in it: depth and velocity
// have one text each (two with an alpha test), the g-buffer one a material, indirect light, normal map and sidedness, and only
// the forward pass looks at lights. Formulas live in lib/, each with its range, unit and source.

#include "surface_axes.glsl"
#include "surface_interface.glsl"

// Forward and g-buffer passes run over a depth pass, test for equal depth, and need no alpha test of their own.
#if ALPHA_TEST && (PASS == PASS_DEPTH || PASS == PASS_VELOCITY)
layout(location = 2) in vec2 material_uv;
layout(set = 1, binding = 1) uniform sampler2D base_map;    // a: opacity

void test_alpha() {
    if (texture(base_map, material_uv).a < base_factor.a) {
        discard;
    }
}
#endif

#if PASS == PASS_DEPTH

void main() {
#if ALPHA_TEST
    test_alpha();
#endif
}

#elif PASS == PASS_VELOCITY

#include "lib/motion.glsl"

layout(location = 4) in vec4 clip_position;
layout(location = 5) in vec4 previous_clip_position;
layout(location = 0) out vec2 motion;

void main() {
#if ALPHA_TEST
    test_alpha();
#endif
    motion = screen_motion(clip_position, previous_clip_position, jitter);
}

#else

#if PRECISION == PRECISION_MEDIUMP
precision highp float;    // of what does not say otherwise
precision highp int;
#endif
#include "lib/math.glsl"
#include "lib/vectors.glsl"

layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec2 material_uv;
#if NORMAL_MAP
layout(location = 6) in vec4 world_tangent;    // w: handedness
#endif

// What is included only where it is called belongs to its own variants, and editing it recompiles no others.
#include "surface_material.glsl"
#if !ADDITIVE
#include "surface_indirect.glsl"
#endif

#if PASS == PASS_GBUFFER

#include "lib/octahedral.glsl"

#if MATERIAL == MATERIAL_BLINN_PHONG
const float shading_model = 0.0;
#else
const float shading_model = 1.0;
#endif
// Where no bake lights the object, its irradiance is the ambient light's, in whose place an environment puts the sky's.
#if LIGHTMAP != LIGHTMAP_NONE || PROBES != PROBES_NONE
const float baked = 1.0;
#else
const float baked = 0.0;
#endif

layout(location = 0) out vec4 gbuffer_diffuse;     // rgb: diffuse reflectance; a: 0 Blinn-Phong, 1 GGX
layout(location = 1) out vec4 gbuffer_specular;    // rgb: F0 or ks; a: perceptual roughness
// Octahedral, [-1, 1]. xy: the shading normal; zw: the surface's without a normal map, the plane that receives shadows. Its four
// bytes a pixel could be saved by differences of depth; but those are of one side's plane and another's at every edge between two
// objects, are facets where normals are smooth, and have the depth's quantum over a pixel's width as their noise.
layout(location = 2) out vec4 gbuffer_normal;
// The fifth target is more than Vulkan and ES 3.0 promise (maxColorAttachments and GL_MAX_DRAW_BUFFERS are 4 at least); drivers of
// GPUs that draw deferred have 8.
// Indirect light and not what is reflected of it: how much the coat leaves for the base is known once the environment is.
layout(location = 3) out vec4 gbuffer_irradiance;    // rgb: indirect irradiance / pi, W/(m2 sr); a: 1 baked, 0 not
layout(location = 4) out vec4 gbuffer_radiance;      // rgb: emission, to which the deferred passes add; a: 1

void main() {
    const vec3 n = shading_normal();
    const Shading s = sample_material();
    gbuffer_diffuse = vec4(s.diffuse, shading_model);
    gbuffer_specular = vec4(s.specular, s.roughness);
    gbuffer_normal = vec4(encode_octahedral(n), encode_octahedral(geometric_normal()));
    gbuffer_irradiance = vec4(indirect_irradiance(world_position, n) / pi, baked);
    gbuffer_radiance = vec4(emissive, 1.0);
}

#else

#if LIGHT_TYPE != LIGHT_NONE
#include "surface_brdf.glsl"
#include "surface_light.glsl"
#include "surface_shadow.glsl"
#endif

layout(location = 0) out vec4 color;    // rgb: scene radiance, linear; a: 1

void main() {
    const vec3 n = shading_normal();
    const Shading s = sample_material();
#if LIGHT_TYPE != LIGHT_NONE || IBL != IBL_NONE
    const vec3 v = safe_normalize(camera_position - world_position, n);
#endif

#if ADDITIVE
    MEDIUM vec3 radiance = vec3(0.0);
#elif IBL == IBL_NONE
    MEDIUM vec3 radiance = s.diffuse / pi * indirect_irradiance(world_position, n) + emissive;
#else
    MEDIUM vec3 radiance = environment_light(world_position, n, v, s.diffuse, s.specular, s.roughness,
                                             indirect_irradiance(world_position, n)) +
                           emissive;
#endif

#if LIGHT_TYPE != LIGHT_NONE
    const vec3 l = direction_to_light(world_position);
    MEDIUM const vec3 reflected = reflected_light(n, v, l, s);
    radiance += reflected * light_irradiance(world_position, l) *
                light_visibility(world_position, geometric_normal(), l);
#endif

    color = vec4(radiance, 1.0);
}

#endif
#endif
