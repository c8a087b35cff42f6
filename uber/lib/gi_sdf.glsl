#ifndef KILN_GI_SDF_GLSL
#define KILN_GI_SDF_GLSL
// Rays and cones through a distance field: Hart, "Sphere Tracing", 1996; Wright, "Dynamic Occlusion with Signed Distance
// Fields", SIGGRAPH 2015 course. The field comes as a volume over an axis-aligned box, or as the analytic distances below,
// whose loops are those of sdf_trace and sdf_visibility with the fetch replaced.
#include "gi_sampling.glsl"

// Distance to a sphere and to a box about 0, negative inside. p: from the centre; half_size: > 0.
float sdf_sphere(vec3 p, float radius) {
    return length(p) - radius;
}
float sdf_box(vec3 p, vec3 half_size) {
    const vec3 q = abs(p) - half_size;
    return length(max(q, vec3(0.0))) + min(max_component(q), 0.0);
}

// Distance to the rectangle origin + [0, 1] u + [0, 1] v, u and v across each other, not negative.
float sdf_rectangle(vec3 p, vec3 origin, vec3 u, vec3 v) {
    const vec3 d = p - origin;
    const float a = saturate(dot(d, u) / dot(u, u));
    const float b = saturate(dot(d, v) / dot(v, v));
    return length(d - u * a - v * b);
}

// Where the volume's box is in the world: texel centres span it when a texel is as wide as size / (texels).
struct SdfVolume {
    vec3 low;
    vec3 size;
};

// The field at p; outside the box what its nearest point has, and the way there.
float sdf_distance(sampler3D field, SdfVolume volume, vec3 p) {
    const vec3 inside = clamp(p, volume.low, volume.low + volume.size);
    return textureLod(field, (inside - volume.low) / volume.size, 0.0).r + length(p - inside);
}

// The part of a disc light or cone that is open at distance t where the nearest surface is d away from the axis, if that
// surface is an edge across it: 1/2 + (u sqrt(1 - u^2) + asin(u)) / pi, u = d / (t tangent). Any d; t >= 0; tangent > 0.
float sdf_open_share(float d, float t, float tangent) {
    const float u = clamp(d / max(t * tangent, 1e-6), -1.0, 1.0);
    const float c = sqrt((1.0 - u) * (1.0 + u));
    return 0.5 + (u * c + atan(u, c)) / pi;
}

// Quilez' soft visibility, k d / t limited to 1: a penumbra that reaches from a shadow outwards only, 1/k wide at unit
// distance. Any d; t: [0, inf), 0 gives 1 beside a surface; k: (0, inf).
float sdf_soft_share(float d, float t, float k) {
    return saturate(k * d / max(t, 1e-6));
}

// Distance along a ray to the first surface, negative if there is none within `reach`. Steps by the distance itself, and
// by no less than `near`, the distance that counts as met.
// direction: unit; start: [0, reach); near: > 0, half a texel for a signed field, a whole one for a field of sheets, whose
// distances have no sign and, filtered, never fall to 0.
#ifndef SDF_STEPS
#define SDF_STEPS 64
#endif
float sdf_trace(sampler3D field, SdfVolume volume, vec3 origin, vec3 direction, float start, float reach, float near) {
    float t = start;
    for (int i = 0; i < SDF_STEPS && t < reach; ++i) {
        const float d = sdf_distance(field, volume, origin + direction * t);
        if (d < near) return t;
        t += d;
    }
    return -1.0;
}

// The open share of a cone: the least of sdf_open_share along its axis; 0 where the axis itself is blocked.
// tangent: of the half angle, (0, inf); others as above.
float sdf_visibility(sampler3D field, SdfVolume volume, vec3 origin, vec3 direction, float tangent, float start, float reach,
                     float near) {
    float open = 1.0;
    float t = start;
    for (int i = 0; i < SDF_STEPS && t < reach; ++i) {
        const float d = sdf_distance(field, volume, origin + direction * t);
        if (d < near) return 0.0;
        open = min(open, sdf_open_share(d, t, tangent));
        t += d;
    }
    return open;
}

// The same after Quilez, with k = 1 / tangent.
float sdf_soft_visibility(sampler3D field, SdfVolume volume, vec3 origin, vec3 direction, float k, float start, float reach,
                          float near) {
    float open = 1.0;
    float t = start;
    for (int i = 0; i < SDF_STEPS && t < reach; ++i) {
        const float d = sdf_distance(field, volume, origin + direction * t);
        if (d < near) return 0.0;
        open = min(open, sdf_soft_share(d, t, k));
        t += d;
    }
    return open;
}

// Irradiance by one bounce from SDF_CONES cones about n, each traced along its axis and worth what the volume of radiance
// (as gi_cones.glsl keeps it, over the same box) holds there, at the level that is as wide as the cone. a: the share met.
// voxel: size of the radiance volume's voxel in the world; near: as above.
#ifndef SDF_CONES
#define SDF_CONES 16
#endif
vec4 sdf_gather(sampler3D field, sampler3D radiance, SdfVolume volume, vec3 position, vec3 n, float reach, float near,
                float voxel, inout uint state) {
    const vec2 shift = vec2(gi_random(state), gi_random(state));
    // SDF_CONES cones share the half space: 2 pi (1 - cos) = 2 pi / SDF_CONES.
    const float cosine = 1.0 - 1.0 / float(SDF_CONES);
    const float tangent = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 1e-3);
    const vec3 origin = position + n * (2.0 * near);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SDF_CONES; ++i) {
        const vec3 direction = gi_cosine_direction(gi_hammersley(i, SDF_CONES, shift), n);
        const float t = sdf_trace(field, volume, origin, direction, 0.0, reach, near);
        if (t < 0.0) continue;
        const float level = log2(max(2.0 * t * tangent / voxel, 1.0));
        const vec3 at = (origin + direction * t - volume.low) / volume.size;
        const vec4 met = textureLod(radiance, at, level);
        sum += vec4(met.a > 0.0 ? met.rgb / met.a : vec3(0.0), 1.0);
    }
    return vec4(sum.rgb * pi, sum.a) / float(SDF_CONES);
}

#endif
