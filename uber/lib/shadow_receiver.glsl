#ifndef KILN_SHADOW_RECEIVER_GLSL
#define KILN_SHADOW_RECEIVER_GLSL
// Where a receiver stands in a shadow map, and how far its own surface rises within the reach of a look-up. Conventions of
// shadow_map.glsl: one Vulkan matrix for map and look-up, z / w is depth as it stands, uv = ndc.xy / 2 + 1/2 with no flip.
#include "math.glsl"

// xyz: uv and depth in the map, w: 1. Where the map knows nothing of the receiver (behind the light's plane, w <= 0; uv or
// depth outside [0, 1]; not a number) the result is (1/2, 1/2, 0, 0): w says lit, and xyz may still be sampled with.
// clip: the receiver in the light's clip space, any values.
vec4 shadow_coordinates(vec4 clip) {
    const bool in_front = clip.w > 0.0;
    const vec3 ndc = clip.xyz / (in_front ? clip.w : 1.0);
    const vec3 place = vec3(ndc.xy * 0.5 + 0.5, ndc.z);
    const bool inside =
        in_front && all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)));
    return inside ? vec4(place, 1.0) : vec4(0.5, 0.5, 0.0, 0.0);
}

// How fast the depth of the receiver's plane grows over the map, in depth units a unit of uv; each within [-limit, limit].
// A plane stays a plane in clip space: p.x x + p.y y + p.z z + p.w = 0 in NDC, hence dz/duv = -2 p.xy / p.z. A plane seen
// edge on (p.z = 0) gives the limit.
// plane: the receiver's plane in the light's clip space, world plane (n, -n.x) times the inverse of the shadow matrix; any
// scale within [1e-6, 1e6]. limit: > 0; 64 is a slope of one map's depth over a 64th of its side.
vec2 receiver_depth_slope(vec4 plane, float limit) {
    const float rise = abs(plane.z) > 1e-30 ? plane.z : 1e-30;
    return clamp(-2.0 * plane.xy / rise, vec2(-limit), vec2(limit));
}

// The same from screen derivatives of (uv, depth), for a receiver of which no plane is known: the gradient g solves
// dx.xy . g = dx.z, dy.xy . g = dy.z. Where the two derivatives are parallel nothing can be told: 0. Isidoro, "Shadow
// Mapping: GPU-based Tips and Techniques", 2006.
vec2 receiver_depth_slope(vec3 dx, vec3 dy, float limit) {
    const float det = dx.x * dy.y - dx.y * dy.x;
    const vec2 g = vec2(dx.z * dy.y - dx.y * dy.z, dx.x * dy.z - dx.z * dy.x);
    const bool sound = abs(det) > 1e-6 * (abs(dx.x * dy.y) + abs(dx.y * dy.x));
    return sound ? clamp(g / det, vec2(-limit), vec2(limit)) : vec2(0.0);
}

// Depth bias at which a plane cannot shadow itself: what it rises on the way to the furthest texel centre that a look-up
// may read, and two quanta of the map for rounding on either side ((z w) / w against z).
// slope: depth a uv, from above. reach: uv; half a texel for a nearest comparison, a whole one for a bilinear one.
// quantum: depth units: 1 / 65535 for D16; 2^-23 for D24 and D32F, half of which is for the matrix product before.
float receiver_depth_bias(vec2 slope, vec2 reach, float quantum) {
    return dot(abs(slope), reach) + 2.0 * quantum;
}

#endif
