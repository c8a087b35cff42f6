#version 450
// Vertex stage of shadow_pass: what casts shadows, seen from the light.

#include "shadow_pass_axes.glsl"
#include "shadow_pass_interface.glsl"

// Of what the kinds and the passes that read them share, depth must agree to the last bit.
invariant gl_Position;

layout(location = 0) in vec3 position;
#if ALPHA_TEST
layout(location = 1) in vec2 uv;
layout(location = 1) out vec2 material_uv;
#endif
#if KIND == KIND_MOMENTS
layout(location = 0) out float light_distance;    // from the light's plane: metres, under a directional light units of depth
#endif

void main() {
    vec4 clip = shadow_view_projection * (model * vec4(position, 1.0));
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    // A caster between the sun and the near plane still casts: its vertices are moved onto the plane rather than clipped. A triangle
    // that crosses the plane is bent by that and stored too deep (.75 for .5 where one goes from z -1 to 1), so the near plane belongs
    // before all that is seen; depthClampEnable in place of this line is exact.
    clip.z = max(clip.z, 0.0);
#endif
    gl_Position = clip;
#if KIND == KIND_MOMENTS
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    light_distance = clip.z;
#else
    light_distance = clip.w;
#endif
#endif
#if ALPHA_TEST
    material_uv = uv;
#endif
}
