#ifndef KILN_GI_SCREEN_GLSL
#define KILN_GI_SCREEN_GLSL
// Indirect light from what is on the screen: rays marched against the depth buffer. What is off the screen or behind
// something is missed, and no number of rays brings it back. McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing",
// JCGT 3(4), 2014. View space looks along -z; depth is Vulkan's, [0, 1]; uv = ndc / 2 + 1/2.
#include "gi_sampling.glsl"

// Distance along the view axis of a depth: p32 / (depth + p22) with the projection's elements. depth: [0, 1].
float screen_distance(float depth, mat4 projection) {
    return projection[3][2] / (depth + projection[2][2]);
}

// The part of a ray of this length that lies before the eye: its length cut where the view distance falls to `nearest`.
// origin, direction: view space, origin before the eye by more than nearest; nearest: metres, > 0.
float screen_clip(vec3 origin, vec3 direction, float reach, float nearest) {
    const float end = -origin.z - direction.z * reach;
    return end < nearest ? (-origin.z - nearest) / direction.z : reach;
}

// A point of the segment between two clip-space points: uv in xy, view distance in z. t steps evenly over the screen:
//   s = t w0 / (t w0 + (1 - t) w1) of the way from start to end. w0, w1 > 0; t: [0, 1].
vec3 screen_point(vec4 start, vec4 end, float t) {
    const float a = t * start.w;
    const vec4 c = mix(start, end, a / (a + (1.0 - t) * end.w));
    return vec3(c.xy / c.w * 0.5 + 0.5, c.w);
}

// Whether a ray that covers these view distances meets a surface that is `thickness` deep. All in metres.
bool screen_meets(float ray_from, float ray_to, float surface, float thickness) {
    return max(ray_from, ray_to) >= surface && min(ray_from, ray_to) <= surface + thickness;
}

// The first of SCREEN_STEPS points of a ray that lies behind the depth buffer by less than thickness: its uv, and whether
// there is one. jitter: [0, 1), moves all points by a part of a step. direction: unit.
#ifndef SCREEN_STEPS
#define SCREEN_STEPS 32
#endif
bool screen_march(sampler2D depth, mat4 projection, vec3 origin, vec3 direction, float reach, float thickness, float jitter,
                  out vec2 hit) {
    const float reached = screen_clip(origin, direction, reach, 1e-3);
    const vec4 start = projection * vec4(origin, 1.0);
    const vec4 end = projection * vec4(origin + direction * reached, 1.0);
    float before = start.w;
    for (int i = 0; i < SCREEN_STEPS; ++i) {
        const vec3 at = screen_point(start, end, (float(i) + 1.0 - jitter) / float(SCREEN_STEPS));
        if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) break;
        const float surface = screen_distance(textureLod(depth, at.xy, 0.0).r, projection);
        if (at.z > surface && screen_meets(before, at.z, surface, thickness)) {
            hit = at.xy;
            return true;
        }
        before = at.z;
    }
    hit = vec2(0.0);
    return false;
}

// Irradiance by one bounce from SCREEN_RAYS rays about n: pi times the mean of the radiance they meet; a: the share of rays
// that met something. radiance: what the pixels send out, as the direct light leaves them. position, n: view space.
#ifndef SCREEN_RAYS
#define SCREEN_RAYS 16
#endif
vec4 screen_gather(sampler2D depth, sampler2D radiance, mat4 projection, vec3 position, vec3 n, float reach, float thickness,
                   inout uint state) {
    const vec2 shift = vec2(gi_random(state), gi_random(state));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SCREEN_RAYS; ++i) {
        const vec3 direction = gi_cosine_direction(gi_hammersley(i, SCREEN_RAYS, shift), n);
        vec2 hit;
        // The start stands off the surface by what the depth buffer may be off by.
        const vec3 start = position + n * (2e-3 * -position.z);
        if (screen_march(depth, projection, start, direction, reach, thickness, gi_random(state), hit))
            sum += vec4(textureLod(radiance, hit, 0.0).rgb, 1.0);
    }
    return vec4(sum.rgb * pi, sum.a) / float(SCREEN_RAYS);
}

#endif
