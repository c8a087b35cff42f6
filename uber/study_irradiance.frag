#version 450
// Diffuse light from a few numbers a place: the forms of spherical harmonics in lib/, an irradiance map, and every way to go between
// probes. A white sphere of radius 1 shows E / pi. The first value of every axis is the form that surface takes; LECTURE is as
// printed in GAMES104 lecture 05. manifests/library.yaml says what goes together.

#define IRRADIANCE_SH_L2_CLAMPED 0
#define IRRADIANCE_SH_L2 1
#define IRRADIANCE_SH_L2_CONVOLVED 2
#define IRRADIANCE_SH_QUADRATIC 3
#define IRRADIANCE_SH_L1 4
#define IRRADIANCE_SH_L1_CONVOLVED 5
#define IRRADIANCE_SH_L1_MOMENTS 6
#define IRRADIANCE_SH_L1_WEIGHTED 7
#define IRRADIANCE_SH_L1_CLAMPED 8
#define IRRADIANCE_SH_L1_NONLINEAR 9
#define IRRADIANCE_SH_L1_ZH3 10
#define IRRADIANCE_SH_L1_ZH3_LUMINANCE 11
#define IRRADIANCE_SH_L1_LIGHTMAP 12
#define IRRADIANCE_CUBE_MAP 13
#define IRRADIANCE_LECTURE 14
#define IRRADIANCE_LECTURE_MERGED 15

#define PROBES_SINGLE 0
#define PROBES_TRILINEAR 1
#define PROBES_TRILINEAR_FACING 2
#define PROBES_TETRAHEDRAL 3
#define PROBES_TETRAHEDRAL_FACING 4

#include "lib/math.glsl"
#include "lib/probes.glsl"
#include "lib/sh.glsl"
#include "lib/vectors.glsl"
#include "study_sphere.glsl"
#if IRRADIANCE == IRRADIANCE_CUBE_MAP
#include "lib/environment.glsl"
#elif IRRADIANCE == IRRADIANCE_SH_L1_LIGHTMAP
#include "lib/sh_lightmap.glsl"
#elif IRRADIANCE == IRRADIANCE_LECTURE || IRRADIANCE == IRRADIANCE_LECTURE_MERGED
#include "lib/lecture_sh.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Irradiance {
    vec4 probe_sh[72];           // eight probes of nine orthonormal coefficients of radiance, rgb; the first alone when single
    vec4 tetrahedron_corner[4];  // xyz: where the first four probes stand when tetrahedral
    vec3 grid_first;             // where the first of 2 x 2 x 2 probes stands, x fastest
    vec3 grid_spacing;           // between them, > 0
};
layout(set = 0, binding = 1) uniform samplerCube irradiance_map;    // E / pi

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: E / pi, linear; a: 1

// Coefficient by coefficient, as drivers take seconds over structures that loops copy.
ShL2 blended(vec3 position, vec3 n) {
    float weights[8] = float[8](1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    int count = 1;
#if PROBES == PROBES_TRILINEAR || PROBES == PROBES_TRILINEAR_FACING
    const GridCell at = probe_grid_cell(position - grid_first, 1.0 / grid_spacing, ivec3(2));
    const TrilinearWeights corners = trilinear_weights(at.t);
    count = 8;
    for (int i = 0; i < 4; ++i) {
        weights[i] = corners.low[i];
        weights[i + 4] = corners.high[i];
    }
#if PROBES == PROBES_TRILINEAR_FACING
    float total = 0.0;
    for (int i = 0; i < 8; ++i) {
        const vec3 place = grid_first + vec3(i & 1, i >> 1 & 1, i >> 2) * grid_spacing;
        weights[i] *= probe_facing_weight(safe_normalize(place - position, n), n);
        total += weights[i];
    }
    for (int i = 0; i < 8; ++i) {
        weights[i] /= total;    // facing weights are 0.2 at least
    }
#endif
#elif PROBES == PROBES_TETRAHEDRAL || PROBES == PROBES_TETRAHEDRAL_FACING
    vec4 corners = tetrahedron_weights(position, tetrahedron_corner[0].xyz, tetrahedron_corner[1].xyz, tetrahedron_corner[2].xyz,
                                       tetrahedron_corner[3].xyz);
#if PROBES == PROBES_TETRAHEDRAL_FACING
    corners = max(corners, vec4(0.0));
    for (int i = 0; i < 4; ++i) {
        corners[i] *= probe_facing_weight(safe_normalize(tetrahedron_corner[i].xyz - position, n), n);
    }
#endif
    corners = normalize_weights(corners);
    count = 4;
    for (int i = 0; i < 4; ++i) {
        weights[i] = corners[i];
    }
#endif
    ShL2 sum;
    for (int k = 0; k < 9; ++k) {
        vec3 c = vec3(0.0);
        for (int i = 0; i < count; ++i) {
            c += weights[i] * probe_sh[9 * i + k].rgb;
        }
        sum.c[k] = c;
    }
    return sum;
}

vec3 irradiance(vec3 position, vec3 n) {
#if IRRADIANCE == IRRADIANCE_CUBE_MAP
    return pi * sample_environment(irradiance_map, n, 0.0, 1.0);
#else
    const ShL2 l2 = blended(position, n);
    const ShL1 l1 = ShL1(vec3[4](l2.c[0], l2.c[1], l2.c[2], l2.c[3]));
#if IRRADIANCE == IRRADIANCE_SH_L2
    return sh_irradiance_from_radiance(l2, n);
#elif IRRADIANCE == IRRADIANCE_SH_L2_CONVOLVED
    return sh_irradiance_convolved(sh_l2_convolve(l2), n);
#elif IRRADIANCE == IRRADIANCE_SH_QUADRATIC
    return sh_quadratic_irradiance(sh_quadratic(l2), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1
    return sh_irradiance_from_radiance(l1, n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_CONVOLVED
    return sh_irradiance_convolved(sh_l1_convolve(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_MOMENTS
    return sh_irradiance_from_moments(sh_moments_of(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_WEIGHTED
    return sh_irradiance_from_weighted(sh_l1_weight(sh_moments_of(l1)), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_CLAMPED
    return sh_irradiance_clamped(sh_moments_of(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_NONLINEAR
    return sh_irradiance_nonlinear(sh_moments_of(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_ZH3
    return sh_irradiance_zh3(sh_moments_of(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_ZH3_LUMINANCE
    return sh_irradiance_zh3_luminance(sh_moments_of(l1), n);
#elif IRRADIANCE == IRRADIANCE_SH_L1_LIGHTMAP
    const ShMomentsL1 m = sh_moments_of(l1);    // there and back through what a texel holds
    return sh_l1_irradiance(m.m0, decode_sh_ratio(encode_sh_ratio(m.m0, m.m1_y)), decode_sh_ratio(encode_sh_ratio(m.m0, m.m1_z)),
                            decode_sh_ratio(encode_sh_ratio(m.m0, m.m1_x)), n);
#elif IRRADIANCE == IRRADIANCE_LECTURE
    vec3 e;
    for (int i = 0; i < 3; ++i) {
        e[i] = sh_irradiance_lecture(vec4(l1.c[0][i], l1.c[1][i], l1.c[2][i], l1.c[3][i]), n);
    }
    return e;
#elif IRRADIANCE == IRRADIANCE_LECTURE_MERGED
    const vec4 weights = sh_evaluate_diffuse_l1_lecture(n);
    return l1.c[0] * weights.x + l1.c[1] * weights.y + l1.c[2] * weights.z + l1.c[3] * weights.w;
#else
    return sh_irradiance_clamped(l2, n);
#endif
#endif
}

void main() {
    const vec3 n = sphere_normal(screen_uv);
    color = vec4(on_sphere(screen_uv) ? irradiance(n, n) / pi : vec3(0.0), 1.0);
}
