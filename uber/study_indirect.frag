#version 450
// Light that has met a surface before, on a white square, by the forms of lib/ but path tracing. The square is the floor y = -1/2 of a room of 1 m about
// 0, seen from above, which fills the volumes; for screen it faces a camera at the origin from 1.5 m. manifests/library.yaml names the
// values.

#define INDIRECT_AMBIENT 0
#define INDIRECT_MULTIBOUNCE 1
#define INDIRECT_INTERREFLECTION 2
#define INDIRECT_RSM_ALL 3
#define INDIRECT_RSM_TAPS 4
#define INDIRECT_CONES 5
#define INDIRECT_SDF_CONES 6
#define INDIRECT_SDF_VISIBILITY 7
#define INDIRECT_SDF_SOFT_VISIBILITY 8
#define INDIRECT_SCREEN 9

#define RSM_SIZE 8
#define RSM_TAPS 8
#define CONE_STEPS 12
#define SDF_CONES 4
#define SDF_STEPS 12
#define SCREEN_RAYS 2
#define SCREEN_STEPS 8
#include "lib/math.glsl"
#include "lib/vectors.glsl"
#if INDIRECT <= INDIRECT_INTERREFLECTION
#include "lib/gi_ambient.glsl"
#elif INDIRECT == INDIRECT_RSM_ALL || INDIRECT == INDIRECT_RSM_TAPS
#include "lib/gi_rsm.glsl"
#elif INDIRECT == INDIRECT_CONES
#include "lib/gi_cones.glsl"
#elif INDIRECT == INDIRECT_SCREEN
#include "lib/gi_screen.glsl"
#else
#include "lib/gi_sdf.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Indirect {
    mat4 screen_projection;    // screen: of the camera
    vec3 ambient;              // irradiance, >= 0; interreflection: emission of the walls
    float reach;               // how far cones and rays go, metres, > 0; rsm_taps: uv
    vec3 wall_albedo;          // [0, 1]
    float tangent;             // sdf_visibility: of the lamp's half angle, > 0
    vec3 lamp_bearing;         // sdf_visibility: to a distant lamp above the floor, need not be of unit length
    float thickness;           // screen: of what the depth buffer shows, metres
};
layout(set = 0, binding = 1) uniform sampler2D rsm_position;      // 8 x 8: world; a: area of a texel there, m2
layout(set = 0, binding = 2) uniform sampler2D rsm_facing;        // normals
layout(set = 0, binding = 3) uniform sampler2D rsm_intensity;
layout(set = 0, binding = 4) uniform sampler3D radiance_volume;   // radiance times opacity, opacity; mips, linear
layout(set = 0, binding = 5) uniform sampler3D distance_field;    // metres, linear
layout(set = 0, binding = 6) uniform sampler2D scene_depth;       // [0, 1], nearest
layout(set = 0, binding = 7) uniform sampler2D scene_radiance;    // linear

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: radiance of a white diffuse square, linear; a: 1

// Irradiance.
vec3 gathered() {
    const vec3 n = vec3(0.0, 1.0, 0.0);
    const vec3 x = vec3(screen_uv.x - 0.5, -0.5, screen_uv.y - 0.5);
    uint state = 7u;    // the same points at every pixel
#if INDIRECT == INDIRECT_AMBIENT
    return pi * ambient_radiance(vec3(1.0), ambient, screen_uv.y);    // down the picture more is open
#elif INDIRECT == INDIRECT_MULTIBOUNCE
    return ambient * multibounce_visibility(screen_uv.y, wall_albedo * screen_uv.x);
#elif INDIRECT == INDIRECT_INTERREFLECTION
    return interreflection(ambient, wall_albedo * screen_uv.x, int(8.0 * screen_uv.y));
#elif INDIRECT == INDIRECT_RSM_ALL
    return rsm_gather_all(rsm_position, rsm_facing, rsm_intensity, x, n);
#elif INDIRECT == INDIRECT_RSM_TAPS
    return rsm_gather(rsm_position, rsm_facing, rsm_intensity, x, n, screen_uv, min(reach, 0.5), vec2(0.28125, 0.0625));
#elif INDIRECT == INDIRECT_CONES
    const float voxel = 1.0 / float(textureSize(radiance_volume, 0).x);
    return cone_gather(radiance_volume, x + 0.5, n, voxel, reach).rgb;
#elif INDIRECT == INDIRECT_SCREEN
    const vec3 at = vec3((screen_uv - 0.5) * vec2(1.0, -1.0), -1.5);
    return screen_gather(scene_depth, scene_radiance, screen_projection, at, vec3(0.0, 0.0, 1.0), reach, thickness, state).rgb;
#else
    const SdfVolume room = SdfVolume(vec3(-0.5), vec3(1.0));
    const float texel = 1.0 / float(textureSize(distance_field, 0).x);
#if INDIRECT == INDIRECT_SDF_CONES
    return sdf_gather(distance_field, radiance_volume, room, x, n, reach, 0.5 * texel,
                      1.0 / float(textureSize(radiance_volume, 0).x), state)
        .rgb;
#else
    const vec3 l = safe_normalize(lamp_bearing, n);
#if INDIRECT == INDIRECT_SDF_VISIBILITY
    return ambient * sdf_visibility(distance_field, room, x + n * texel, l, tangent, 0.0, reach, 0.5 * texel);
#else
    return ambient * sdf_soft_visibility(distance_field, room, x + n * texel, l, 1.0 / tangent, 0.0, reach, 0.5 * texel);
#endif
#endif
#endif
}

void main() {
    color = vec4(gathered() / pi, 1.0);
}
