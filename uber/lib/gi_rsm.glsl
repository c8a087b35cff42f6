#ifndef KILN_GI_RSM_GLSL
#define KILN_GI_RSM_GLSL
// One bounce of indirect light from a reflective shadow map: every texel that a light sees is a small lamp.
// Dachsbacher and Stamminger, "Reflective Shadow Maps", I3D 2005. Nothing is tested for being in between.
//
// Three maps of one size: position (world), normal (unit), and intensity: what the texel sends along its normal in W/sr,
// albedo times the flux that it receives over pi. From a point light of intensity I: I solid_angle albedo / pi.
#include "gi_sampling.glsl"

// Irradiance at x from a lamp at y, E = I max(0, m.(x - y)) max(0, n.(y - x)) / |x - y|^4 (the paper's equation 1), which
// has no bound as x nears y: the square of the distance is kept at `nearest` or above.
// x, n: receiver, n unit; y, m: lamp, m unit; intensity: along m, W/sr; nearest: m^2, > 0, a texel's area on its surface.
vec3 rsm_irradiance(vec3 x, vec3 n, vec3 y, vec3 m, vec3 intensity, float nearest) {
    const vec3 d = y - x;
    const float square = dot(d, d);
    const float cosines = max(dot(m, -d), 0.0) * max(dot(n, d), 0.0) / max(square, 1e-20);
    return intensity * (cosines / max(square, nearest));
}

// The same for a lamp that is a disc of this area: r^2 / (d^2 + r^2) is a facing disc's form factor, so that the distance
// keeps no hard edge and E never exceeds pi times the lamp's radiance, intensity / area. area: m^2, > 0.
vec3 rsm_disc_irradiance(vec3 x, vec3 n, vec3 y, vec3 m, vec3 intensity, float area) {
    const vec3 d = y - x;
    const float square = dot(d, d);
    const float cosines = max(dot(m, -d), 0.0) * max(dot(n, d), 0.0) / max(square, 1e-20);
    return intensity * (cosines / (square + area / pi));
}

// Direction i of a map over the half space about `axis` in which every texel of RSM_SIZE^2 has the same solid angle,
// 2 pi / RSM_SIZE^2: cos(theta) in equal steps, phi in equal steps. texel: [0, RSM_SIZE)^2.
#ifndef RSM_SIZE
#define RSM_SIZE 16
#endif
vec3 rsm_direction(ivec2 texel, vec3 axis) {
    vec3 t, b;
    gi_basis(axis, t, b);
    const float z = (float(texel.y) + 0.5) / float(RSM_SIZE);
    const vec2 p = -sqrt((1.0 - z) * (1.0 + z)) * cos_sin_of_turn((float(texel.x) + 0.5) / float(RSM_SIZE));
    return t * p.x + b * p.y + axis * z;
}

// All texels of maps of RSM_SIZE^2: 64, 256, 1024 lamps for 8, 16, 32. Texels with a zero normal see nothing.
// area: of a texel on its surface, m^2, in the position map's a.
vec3 rsm_gather_all(sampler2D positions, sampler2D normals, sampler2D intensities, vec3 x, vec3 n) {
    vec3 sum = vec3(0.0);
    for (int j = 0; j < RSM_SIZE; ++j)
        for (int i = 0; i < RSM_SIZE; ++i) {
            const vec4 y = texelFetch(positions, ivec2(i, j), 0);
            const vec3 m = texelFetch(normals, ivec2(i, j), 0).xyz;
            sum += rsm_irradiance(x, n, y.xyz, m, texelFetch(intensities, ivec2(i, j), 0).rgb, y.a);
        }
    return sum;
}

// A point of the paper's pattern about uv in the map, at the radius reach u1 and the angle 2 pi u2: the offset in uv, and in
// z the weight that makes the mean estimate the sum over the disc's texels. Points stand with the density
// 1 / (2 pi reach^2 u1), texels with size^2: the weight is 2 pi reach^2 size^2 u1. (The paper weighs by u1^2, which dims
// what is near.) u: [0, 1)^2; reach: uv; size: texels a side.
vec3 rsm_tap(vec2 u, float reach, float size) {
    return vec3(-reach * u.x * cos_sin_of_turn(u.y), 2.0 * pi * reach * reach * u.x * size * size);
}

// RSM_TAPS texels about uv, where the receiver stands in the map, weighted so that the mean estimates the sum over all
// texels within reach. shift: [0, 1)^2, another for every pixel.
#ifndef RSM_TAPS
#define RSM_TAPS 64
#endif
vec3 rsm_gather(sampler2D positions, sampler2D normals, sampler2D intensities, vec3 x, vec3 n, vec2 uv, float reach,
                vec2 shift) {
    const float size = float(textureSize(positions, 0).x);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < RSM_TAPS; ++i) {
        const vec3 tap = rsm_tap(gi_hammersley(i, RSM_TAPS, shift), reach, size);
        const vec2 at = uv + tap.xy;
        if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0)))) continue;
        const ivec2 texel = ivec2(at * size);
        const vec4 y = texelFetch(positions, texel, 0);
        const vec3 m = texelFetch(normals, texel, 0).xyz;
        sum += tap.z * rsm_irradiance(x, n, y.xyz, m, texelFetch(intensities, texel, 0).rgb, y.a);
    }
    return sum / float(RSM_TAPS);
}

#endif
