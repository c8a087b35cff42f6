#ifndef KILN_GI_CONES_GLSL
#define KILN_GI_CONES_GLSL
// Indirect light from cones through a mip-mapped volume of radiance. Crassin et al., "Interactive Indirect Illumination
// Using Voxel Cone Tracing", Computer Graphics Forum 30(7), 2011. Lengths are in the volume's own units: it fills
// [0, 1]^3. rgb: radiance times opacity; a: opacity of a path one voxel of that level long.
#include "gi_sampling.glsl"

// Level whose voxels are as wide as the cone at distance t: log2(2 t tan / voxel), not below 0.
// t: [0, inf); tangent: of the half angle, (0, inf); voxel: size at level 0.
float cone_level(float t, float tangent, float voxel) {
    return log2(max(2.0 * t * tangent / voxel, 1.0));
}

// Opacity of a path `ratio` times as long as the one that alpha stands for: 1 - (1 - alpha)^ratio. For small alpha the
// difference is its series. alpha: [0, 1]; ratio: [0, 16].
float cone_opacity(float alpha, float ratio) {
    if (alpha >= 1.0) return ratio > 0.0 ? 1.0 : 0.0;
    if (alpha < 1e-3)
        return ratio * alpha * (1.0 - (ratio - 1.0) * alpha * (0.5 - (ratio - 2.0) * alpha / 6.0));
    return 1.0 - exp2(ratio * log2(1.0 - alpha));
}

// Front to back: what was gathered, then `behind`, seen through what it left open. Both are radiance times opacity, opacity.
vec4 cone_over(vec4 gathered, vec4 behind) {
    return gathered + behind * (1.0 - gathered.a);
}

// Along one cone from `start` on: rgb radiance, a opacity. Steps are half as long as the cone is wide, at least half a
// voxel, CONE_STEPS of them or until less than 1 % is left open.
// origin: in the volume; direction: unit; tangent: of the half angle; voxel: size at level 0; start: about one voxel, so
// that a surface does not see itself; reach: how far.
#ifndef CONE_STEPS
#define CONE_STEPS 64
#endif
vec4 cone_march(sampler3D volume, vec3 origin, vec3 direction, float tangent, float voxel, float start, float reach) {
    vec4 gathered = vec4(0.0);
    float t = start;
    for (int i = 0; i < CONE_STEPS && t < reach && gathered.a < 0.99; ++i) {
        const float level = cone_level(t, tangent, voxel);
        const float size = voxel * exp2(level);
        const vec4 here = textureLod(volume, origin + direction * t, level);
        const float opacity = cone_opacity(min(here.a, 1.0), 0.5);
        gathered = cone_over(gathered, vec4(here.a > 0.0 ? here.rgb * (opacity / here.a) : vec3(0.0), opacity));
        t += 0.5 * size;
    }
    return gathered;
}

// Cone i of the six of 60 degrees that cover the half space: one along n, five leaning by 60 degrees. xyz: direction;
// w: weight, the share of the cosine, 1/4 and 3/20. Their sum is 1. i: [0, 6); n: unit.
vec4 cone_of_six(int i, vec3 n) {
    if (i == 0) return vec4(n, 0.25);
    vec3 t, b;
    gi_basis(n, t, b);
    const float phi = 2.0 * pi / 5.0 * float(i > 2 ? i - 5 : i);    // within [-pi, pi]
    return vec4(0.8660254 * (t * cos(phi) + b * sin(phi)) + 0.5 * n, 0.15);
}

// Irradiance by one bounce: pi times the weighted radiance of the six cones. a: their weighted opacity.
vec4 cone_gather(sampler3D volume, vec3 position, vec3 n, float voxel, float reach) {
    vec4 sum = vec4(0.0);
    const vec3 origin = position + n * voxel;
    for (int i = 0; i < 6; ++i) {
        const vec4 cone = cone_of_six(i, n);
        sum += cone.w * cone_march(volume, origin, cone.xyz, 0.57735027, voxel, voxel, reach);
    }
    return vec4(sum.rgb * pi, sum.a);
}

#endif
