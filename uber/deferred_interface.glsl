// What the deferred passes read of surface's g-buffer pass. Set 3; set 0 is as in surface_interface.glsl.

#include "lib/octahedral.glsl"
#include "lib/screen.glsl"

layout(std140, set = 3, binding = 0) uniform Screen {
    mat4 world_of_clip;    // inverse of view_projection
};
layout(set = 3, binding = 1) uniform sampler2D gbuffer_diffuse;     // as surface.frag writes them; read texel by texel
layout(set = 3, binding = 2) uniform sampler2D gbuffer_specular;
layout(set = 3, binding = 3) uniform sampler2D gbuffer_normal;
layout(set = 3, binding = 4) uniform sampler2D gbuffer_irradiance;
layout(set = 3, binding = 5) uniform sampler2D gbuffer_depth;

layout(location = 0) in vec2 screen_uv;

struct Pixel {
    vec3 position;              // world
    vec3 n;                     // unit; for shading
    vec3 geometric_n;           // unit; of the plane that receives shadows
    vec3 diffuse;               // [0, 1]
    vec3 specular;              // F0, for Blinn-Phong ks; [0, 1]
    float roughness;            // perceptual, [0, 1]
    vec3 irradiance_over_pi;    // indirect, W/(m2 sr); >= 0
    bool ggx;                   // else Blinn-Phong
    bool baked;                 // by a lightmap or probes: no sky takes the irradiance's place
    bool drawn;                 // something is there
};

Pixel read_pixel() {
    const ivec2 at = ivec2(gl_FragCoord.xy);
    const vec4 diffuse = texelFetch(gbuffer_diffuse, at, 0);
    const vec4 specular = texelFetch(gbuffer_specular, at, 0);
    const vec4 normals = texelFetch(gbuffer_normal, at, 0);
    const vec4 irradiance = texelFetch(gbuffer_irradiance, at, 0);
    const float depth = texelFetch(gbuffer_depth, at, 0).r;
    Pixel p;
    p.position = screen_to_world(world_of_clip, screen_uv, depth);
    p.n = decode_octahedral(normals.xy);
    p.geometric_n = decode_octahedral(normals.zw);
    p.diffuse = diffuse.rgb;
    p.specular = specular.rgb;
    p.roughness = specular.a;
    p.ggx = diffuse.a > 0.5;
    p.irradiance_over_pi = irradiance.rgb;
    p.baked = irradiance.a > 0.5;
    p.drawn = depth < 1.0;
    return p;
}
