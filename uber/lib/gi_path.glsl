#ifndef KILN_GI_PATH_GLSL
#define KILN_GI_PATH_GLSL
// Indirect light by tracing paths through a scene of rectangles, and what the other forms are baked from: the field of
// distances, the volume of radiance. The scene comes through two macros, to be defined before this file is included:
//   GI_QUADS     how many rectangles
//   GI_QUAD(i)   rectangle i, a GiQuad: an element of a buffer, of a uniform or of a constant array
// gi_cornell.glsl defines them for three small rooms.
#include "gi_quad.glsl"
#include "gi_sampling.glsl"

#ifdef GI_QUADS

// The nearest rectangle that the ray meets beyond `start` and within `reach`: its index, or -1; t: how far.
int gi_trace(vec3 origin, vec3 direction, float start, float reach, out float t) {
    int nearest = -1;
    t = reach;
    for (int i = 0; i < GI_QUADS; ++i) {
        const vec3 u = GI_QUAD(i).u;
        const vec3 v = GI_QUAD(i).v;
        const vec3 n = cross(u, v);
        const float slope = dot(n, direction);
        const vec3 d = GI_QUAD(i).origin - origin;
        if (abs(slope) < 1e-30) continue;
        const float at = dot(n, d) / slope;
        if (!(at > start && at < t)) continue;
        const vec3 p = direction * at - d;
        const float a = dot(p, u) / dot(u, u);
        const float b = dot(p, v) / dot(v, v);
        if (a < 0.0 || a > 1.0 || b < 0.0 || b > 1.0) continue;
        t = at;
        nearest = i;
    }
    return nearest;
}

// The same, with what is met. Fields are taken where the loop stands: an array of constants indexed by a result would become
// a ladder of branches for every field.
bool gi_meet(vec3 origin, vec3 direction, float start, float reach, out float t, out vec3 n, out vec3 albedo, out vec3 emission) {
    bool met = false;
    t = reach;
    n = vec3(0.0);
    albedo = vec3(0.0);
    emission = vec3(0.0);
    for (int i = 0; i < GI_QUADS; ++i) {
        const vec3 u = GI_QUAD(i).u;
        const vec3 v = GI_QUAD(i).v;
        const vec3 across = cross(u, v);
        const float slope = dot(across, direction);
        const vec3 d = GI_QUAD(i).origin - origin;
        const float at = dot(across, d) / (abs(slope) < 1e-30 ? 1e-30 : slope);
        const vec3 p = direction * at - d;
        const float a = dot(p, u) / dot(u, u);
        const float b = dot(p, v) / dot(v, v);
        if (abs(slope) >= 1e-30 && at > start && at < t && a >= 0.0 && a <= 1.0 && b >= 0.0 && b <= 1.0) {
            met = true;
            t = at;
            n = across;
            albedo = GI_QUAD(i).albedo;
            emission = GI_QUAD(i).emission;
        }
    }
    n *= inversesqrt(max(dot(n, n), 1e-30));
    return met;
}

// Irradiance at x, n straight from the lamp, 0 in shadow.
vec3 gi_direct(GiLamp lamp, vec3 x, vec3 n) {
    const vec3 d = lamp.position - x;
    const float square = max(dot(d, d), 1e-8);
    const vec3 l = d * inversesqrt(square);
    if (dot(n, l) <= 0.0 || dot(lamp.axis, l) >= 0.0) return vec3(0.0);
    float t;
    const float distance = sqrt(square);
    if (gi_trace(x, l, 1e-4, distance * 0.9999, t) >= 0) return vec3(0.0);
    return lamp.intensity * (dot(n, l) / square);
}

// Radiance that comes back along a ray: emission, and the lamp's light after at most `bounces` diffuse reflections, of which
// the first is at what the ray meets. With bounces = 0 emission alone. One path; the mean of many is the light.
vec3 gi_path(GiLamp lamp, vec3 origin, vec3 direction, int bounces, inout uint state) {
    vec3 sum = vec3(0.0);
    vec3 weight = vec3(1.0);
    for (int bounce = 0; bounce <= bounces; ++bounce) {
        float t;
        vec3 n, albedo, emission;
        if (!gi_meet(origin, direction, 1e-4, 1e30, t, n, albedo, emission) || dot(n, direction) >= 0.0) break;
        sum += weight * emission;
        if (bounce == bounces) break;
        weight *= albedo;
        origin += direction * t;
        sum += weight * gi_direct(lamp, origin, n) / pi;
        direction = gi_cosine_direction(vec2(gi_random(state), gi_random(state)), n);
    }
    return sum;
}

// Irradiance at x, n from GI_PATHS paths: pi times their mean, without the lamp's own direct light.
#ifndef GI_PATHS
#define GI_PATHS 64
#endif
vec3 gi_path_irradiance(GiLamp lamp, vec3 x, vec3 n, int bounces, inout uint state) {
    vec3 sum = vec3(0.0);
    const vec2 shift = vec2(gi_random(state), gi_random(state));
    for (int i = 0; i < GI_PATHS; ++i) {
        const vec3 direction = gi_cosine_direction(gi_hammersley(i, GI_PATHS, shift), n);
        sum += gi_path(lamp, x, direction, bounces, state);
    }
    return sum * (pi / float(GI_PATHS));
}

// Distance from p to the nearest rectangle: a texel of the field of gi_sdf.glsl.
float gi_distance(vec3 p) {
    float nearest = 1e30;
    for (int i = 0; i < GI_QUADS; ++i) {
        const vec3 d = p - GI_QUAD(i).origin;
        const vec3 u = GI_QUAD(i).u;
        const vec3 v = GI_QUAD(i).v;
        nearest = min(nearest, length(d - u * saturate(dot(d, u) / dot(u, u)) - v * saturate(dot(d, v) / dot(v, v))));
    }
    return nearest;
}

// A voxel of the volume of gi_cones.glsl: radiance that the rectangles through it send out after the lamp's direct light,
// times opacity; opacity 1 where there is one. centre: of the voxel; size: its side.
vec4 gi_voxel(GiLamp lamp, vec3 centre, float size) {
    vec3 sum = vec3(0.0);
    float count = 0.0;
    for (int i = 0; i < GI_QUADS; ++i) {
        const vec3 u = GI_QUAD(i).u;
        const vec3 v = GI_QUAD(i).v;
        const vec3 d = centre - GI_QUAD(i).origin;
        const vec3 on = GI_QUAD(i).origin + u * saturate(dot(d, u) / dot(u, u)) + v * saturate(dot(d, v) / dot(v, v));
        if (max_component(abs(on - centre)) > 0.5 * size) continue;
        const vec3 n = normalize(cross(u, v));
        sum += GI_QUAD(i).emission + GI_QUAD(i).albedo * gi_direct(lamp, on + n * (0.01 * size), n) / pi;
        count += 1.0;
    }
    return count > 0.0 ? vec4(sum / count, 1.0) : vec4(0.0);
}

#endif
#endif
