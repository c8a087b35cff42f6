#ifndef KILN_IBL_GLSL
#define KILN_IBL_GLSL
// Image-based light when shading. Three tables stand for the integral (baked by ibl_bake.glsl):
//   the irradiance map      E(n) / pi, the radiance of a white diffuse surface: no further 1 / pi when shading
//   the prefiltered map     radiance around R, blurred by the GGX lobe of each mip's roughness as seen from N = V = R
//   the split-sum table     A, B over (n.v, roughness), so that the lobe's albedo is F0 A + F90 B
// Karis, "Real Shading in Unreal Engine 4", 2013; Lagarde and de Rousiers 2014, section 4.9.
#include "fresnel.glsl"
#include "math.glsl"

// Where the table holds (n.v, roughness): its first and last texels' centres are 0 and 1. n_dot_v, roughness: limited to
// [0, 1] here; size: texels a side.
vec2 split_sum_uv(float n_dot_v, float roughness, float size) {
    return (vec2(saturate(n_dot_v), saturate(roughness)) * (size - 1.0) + 0.5) / size;
}

// What texel (x, y) of such a table is baked for. texel: [0, size); size: >= 2.
vec2 split_sum_texel(ivec2 texel, int size) {
    return vec2(texel) / float(size - 1);
}

// A and B. The sampler clamps and is bilinear. From roughness 0.1 and n.v 0.05 on, a 32^2 table is within 0.003 and 0.005 of
// the integrals, 64^2 within 0.0007 and 0.001: a quarter of what it would be with (i + 1/2) / size at the texels.
vec2 split_sum_lookup(sampler2D table, float n_dot_v, float roughness, float size) {
    return textureLod(table, split_sum_uv(n_dot_v, roughness, size), 0.0).rg;
}

// A and B without a table: a fit to the Karis form of the integrals (its geometry term, not height-correlated Smith), off by
// up to 0.18 in A and 0.19 in B (n.v from 0.02 on). Karis, "Physically Based Shading on Mobile", 2014, after Lazarov 2013.
// n_dot_v: limited to [0, 1] here; roughness: perceptual, [0, 1]. Never negative, B at most 1.
vec2 split_sum_fit(float n_dot_v, float roughness) {
    const vec4 r = saturate(roughness) * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    const float a004 = min(r.x * r.x, exp2(-9.28 * saturate(n_dot_v))) * r.x + r.y;
    return clamp(vec2(-1.04, 1.04) * a004 + r.zw, vec2(0.0), vec2(1.0));
}

// The specular part, with single scattering: prefiltered (F0 A + F90 B). prefiltered: >= 0; f0, ab: [0, 1].
vec3 environment_specular(vec3 prefiltered, vec3 f0, vec2 ab) {
    return prefiltered * (f0 * ab.x + vec3(fresnel_f90(f0) * ab.y));
}

// The same times 1 + F0 (1 / E - 1), E = A + B: what is lost between microfacets comes back, a white metal reflects all.
// Lagarde and Golubev in Filament's guide, section 4.7.2. E is held at or above 1e-3.
vec3 environment_specular_multiscatter(vec3 prefiltered, vec3 f0, vec2 ab) {
    return environment_specular(prefiltered, f0, ab) * (vec3(1.0) + f0 * (1.0 / clamp(ab.x + ab.y, 1e-3, 1.0) - 1.0));
}

// Diffuse and specular together: what the coat reflects at once and after further bounces is taken from the base, so that a
// furnace of 1 gives at most 1, and exactly 1 for white. Light of further bounces has lost its direction and is taken from
// the irradiance map. Fdez-Aguera, "A Multiple-Scattering Microfacet Model for Real-Time Image-Based Lighting", JCGT 8(1),
// 2019. diffuse: [0, 1], 0 for a metal; irradiance_over_pi, prefiltered: >= 0, W/(m2 sr); f0, ab: [0, 1], A + B <= 1.
vec3 image_based_light(vec3 diffuse, vec3 f0, vec3 irradiance_over_pi, vec3 prefiltered, vec2 ab) {
    const vec3 single = f0 * ab.x + vec3(fresnel_f90(f0) * ab.y);
    const float lost = saturate(1.0 - ab.x - ab.y);
    const vec3 average = fresnel_average(f0);
    const vec3 multiple = lost * single * average / max(vec3(1.0) - lost * average, vec3(1e-3));
    const vec3 below = diffuse * max(vec3(1.0) - single - multiple, vec3(0.0));
    return single * prefiltered + (multiple + below) * irradiance_over_pi;
}

#endif
