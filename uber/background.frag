#version 450
// What is seen where nothing is: the sky, at the far plane.

#define SKY_CUBE 0
#define SKY_EQUIRECT 1

#include "lib/environment.glsl"
#include "lib/screen.glsl"
#include "lib/vectors.glsl"

layout(std140, set = 0, binding = 0) uniform Background {
    mat4 world_of_clip;     // inverse of world to clip
    float sky_intensity;    // multiplies the map, >= 0
    float sky_level;        // mip to show, >= 0; 0 sharp
};
#if SKY == SKY_CUBE
layout(set = 0, binding = 1) uniform samplerCube sky_cube;
#else
layout(set = 0, binding = 2) uniform sampler2D sky_picture;    // repeat in u, clamp in v
#endif

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: scene radiance, linear; a: 1

void main() {
    const vec3 d = safe_normalize(screen_ray(world_of_clip, screen_uv), vec3(0.0, 1.0, 0.0));
#if SKY == SKY_CUBE
    const vec3 seen = textureLod(sky_cube, d, sky_level).rgb;
#else
    const vec3 seen = sample_equirect(sky_picture, d, sky_level);
#endif
    color = vec4(seen * sky_intensity, 1.0);
}
