#version 450
// Vertex stage of surface. Only the pass, and whether there are a lightmap, a normal map and an alpha test, change its text;
// lights, materials and shadows do not, so all of their variants share it.

#include "surface_axes.glsl"
#include "surface_interface.glsl"
#include "lib/vectors.glsl"

// The depth pass and the passes that test against its depth must agree to the last bit.
invariant gl_Position;

layout(location = 0) in vec3 position;

#if PASS == PASS_FORWARD || PASS == PASS_GBUFFER
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
layout(location = 2) out vec2 material_uv;
#if LIGHTMAP != LIGHTMAP_NONE
layout(location = 3) in vec2 lightmap_uv;
layout(location = 3) out vec2 atlas_uv;
#endif
#if NORMAL_MAP
layout(location = 4) in vec4 tangent;    // w: handedness, its sign counts
layout(location = 6) out vec4 world_tangent;
#endif
#else
#if ALPHA_TEST
layout(location = 2) in vec2 uv;
layout(location = 2) out vec2 material_uv;
#endif
#if PASS == PASS_VELOCITY
layout(location = 4) out vec4 clip_position;
layout(location = 5) out vec4 previous_clip_position;
#endif
#endif

void main() {
    const vec4 world = model * vec4(position, 1.0);
    const vec4 clip = view_projection * world;
    gl_Position = clip;

#if PASS == PASS_FORWARD || PASS == PASS_GBUFFER
    world_position = world.xyz;
    world_normal = transform_normal(mat3(model), normal);
    material_uv = uv;
#if LIGHTMAP != LIGHTMAP_NONE
    atlas_uv = lightmap_uv * lightmap_rect.xy + lightmap_rect.zw;
#endif
#if NORMAL_MAP
    world_tangent = vec4(mat3(model) * tangent.xyz, tangent.w);
#endif
#else
#if ALPHA_TEST
    material_uv = uv;
#endif
#if PASS == PASS_VELOCITY
    clip_position = clip;
    previous_clip_position = previous_view_projection * (previous_model * vec4(position, 1.0));
#endif
#endif
}
