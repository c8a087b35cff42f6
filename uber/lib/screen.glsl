#ifndef KILN_SCREEN_GLSL
#define KILN_SCREEN_GLSL
// From the screen back into the world.

// Where a pixel's depth lies, for the inverse of a matrix that is not singular. What lies at infinity (w = 0), as on the far plane
// of an infinite projection, comes out 1e20 times as far as its direction is long, and finite.
// world_of_clip: inverse of world to clip; uv: [0, 1], v down; depth: [0, 1] as Vulkan has it.
vec3 screen_to_world(mat4 world_of_clip, vec2 uv, float depth) {
    const vec4 p = world_of_clip * vec4(uv * 2.0 - 1.0, depth, 1.0);
    return p.xyz / (abs(p.w) > 1e-20 ? p.w : 1e-20);
}

// The direction, not of unit length, from the eye through a pixel: between two points of its line of sight, each kept over its
// w, so that neither may be at infinity. world_of_clip, uv: as above, of a perspective view with depth 0 at its near plane.
vec3 screen_ray(mat4 world_of_clip, vec2 uv) {
    const vec2 ndc = uv * 2.0 - 1.0;
    const vec4 near = world_of_clip * vec4(ndc, 0.0, 1.0);
    const vec4 far = world_of_clip * vec4(ndc, 1.0, 1.0);
    return far.xyz * near.w - near.xyz * far.w;
}

#endif
