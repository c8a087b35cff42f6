#version 450
// What a surface reflects of one light, by the forms that lib/ has: a sphere under a small light nearby. The first value of every
// axis is a right form; LECTURE is as printed in GAMES104 lecture 05. manifests/library.yaml says what goes together.

// How parameters become reflectances and alpha: limited to [0, 1], let through as far as results stay finite, or as printed.
#define PARAMETERS_LIMITED 0
#define PARAMETERS_PUSHED 1
#define PARAMETERS_LECTURE 2

// Microfacets: a lobe of the terms below. The others are whole models.
#define MODEL_MICROFACETS 0
#define MODEL_COOK_TORRANCE 1
#define MODEL_COOK_TORRANCE_HAMMON 2
#define MODEL_COOK_TORRANCE_LECTURE 3
#define MODEL_BLINN_PHONG 4
#define MODEL_BLINN_PHONG_RAW 5
#define MODEL_BLINN_PHONG_LECTURE 6
#define MODEL_DISNEY 7
#define MODEL_MERL_NEAREST 8
#define MODEL_MERL_LINEAR 9
#define MODEL_MERL_FILTERED 10

#define DISTRIBUTION_GGX 0
#define DISTRIBUTION_GGX_CROSS 1
#define DISTRIBUTION_GGX_COSINE 2
#define DISTRIBUTION_GGX_SINE 3
#define DISTRIBUTION_GTR1 4
#define DISTRIBUTION_LECTURE 5

#define VISIBILITY_HEIGHT_CORRELATED 0
#define VISIBILITY_HEIGHT_CORRELATED_PUSHED 1
#define VISIBILITY_SEPARABLE 2
#define VISIBILITY_KARIS_DIRECT 3
#define VISIBILITY_KARIS_IBL 4
#define VISIBILITY_HAMMON 5
#define VISIBILITY_KELEMEN 6
#define VISIBILITY_IMPLICIT 7
#define VISIBILITY_LECTURE 8

#define FRESNEL_SCHLICK 0
#define FRESNEL_SCHLICK_POW 1
#define FRESNEL_SCHLICK_F90 2
#define FRESNEL_SCHLICK_PUSHED 3
#define FRESNEL_SPHERICAL_GAUSSIAN 4
#define FRESNEL_F82 5
#define FRESNEL_DIELECTRIC 6
#define FRESNEL_CONDUCTOR 7
#define FRESNEL_LECTURE 8

// Added to the lobe without anything taken from it, as in Disney's model.
#define DIFFUSE_NONE 0
#define DIFFUSE_LAMBERT 1
#define DIFFUSE_DISNEY 2
#define DIFFUSE_DISNEY_RENORMALISED 3
#define DIFFUSE_DISNEY_SUBSURFACE 4

#define ENERGY_SINGLE 0
#define ENERGY_SCALED 1
#define ENERGY_KULLA_CONTY 2

#include "lib/material_models.glsl"
#include "lib/math.glsl"
#include "lib/vectors.glsl"
#include "study_sphere.glsl"

layout(std140, set = 0, binding = 0) uniform Brdf {
    vec3 lamp_bearing;       // from the sphere's centre to the lamp, need not be of unit length
    float lamp_height;       // of the lamp over a sphere of twice the radius, in radii, >= 0
    vec3 lamp_brightness;    // irradiance over pi where the lamp stands overhead: what a white diffuse surface would show; >= 0
    float roughness;         // perceptual
    vec3 base_colour;        // linear
    float metallic;
    float dielectric_specular;    // f0 of a dielectric in units of 0.08
    float shininess;              // of the Blinn-Phong models
    float albedo_average;         // 2 integral of E(m) m dm of the lobe at this roughness, (0, 1]
    float split_sum_size;         // texels a side of split_sum_table, >= 2
    vec3 fresnel_edge;            // reflectance at grazing incidence (schlick_f90) or at 82 degrees (f82)
    float ior;                    // dielectric: index inside over outside, [0.1, 1e3]
    vec3 eta;                     // conductor: complex index, [0, 1e3], not both 0
    float subsurface;             // Disney's parameters, [0, 1]
    vec3 k;
    float sheen;
    float specular_tint;
    float sheen_tint;
    float clearcoat;
    float clearcoat_gloss;
};
layout(set = 0, binding = 1) uniform sampler2D split_sum_table;
// Measured: 182 x 90 x 90 texels as merl.glsl lays them out, linear and clamped.
layout(set = 0, binding = 2) uniform sampler3D merl_table;

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: scene radiance, linear; a: 1

#if MODEL == MODEL_MICROFACETS

#include "lib/energy.glsl"
#include "lib/fresnel.glsl"
#include "lib/ggx.glsl"
#if DISTRIBUTION == DISTRIBUTION_GGX_CROSS || DISTRIBUTION == DISTRIBUTION_GGX_COSINE || DISTRIBUTION == DISTRIBUTION_GGX_SINE
#include "lib/ggx_forms.glsl"
#elif DISTRIBUTION == DISTRIBUTION_GTR1
#include "lib/gtr.glsl"
#endif
#if VISIBILITY != VISIBILITY_HEIGHT_CORRELATED && VISIBILITY != VISIBILITY_LECTURE
#include "lib/smith.glsl"
#endif
#if FRESNEL == FRESNEL_DIELECTRIC || FRESNEL == FRESNEL_CONDUCTOR
#include "lib/fresnel_exact.glsl"
#elif FRESNEL != FRESNEL_SCHLICK && FRESNEL != FRESNEL_LECTURE
#include "lib/fresnel_fits.glsl"
#endif
#if DIFFUSE >= DIFFUSE_DISNEY
#include "lib/disney.glsl"
#endif
#if ENERGY != ENERGY_SINGLE
#include "lib/ibl.glsl"
#endif
#if DISTRIBUTION == DISTRIBUTION_LECTURE || VISIBILITY == VISIBILITY_LECTURE
#include "lib/lecture_brdf.glsl"
#elif FRESNEL == FRESNEL_LECTURE || PARAMETERS == PARAMETERS_LECTURE
#include "lib/lecture_brdf.glsl"
#endif

#if PARAMETERS == PARAMETERS_PUSHED
#define ALPHA_OF ggx_alpha_pushed
#else
#define ALPHA_OF ggx_alpha
#endif

float distribution(vec3 n, vec3 h) {
#if DISTRIBUTION == DISTRIBUTION_GGX_CROSS
    return ggx_distribution_cross(n, h, ALPHA_OF(roughness));
#elif DISTRIBUTION == DISTRIBUTION_GGX_COSINE
    return ggx_distribution_cosine(dot(n, h), ALPHA_OF(roughness));
#elif DISTRIBUTION == DISTRIBUTION_GGX_SINE
    const vec3 across = cross(n, h);
    return ggx_from_sine(saturate(dot(n, h)), saturate(dot(across, across)), ALPHA_OF(roughness));
#elif DISTRIBUTION == DISTRIBUTION_GTR1
    return gtr1_distribution(n, h, ALPHA_OF(roughness));
#elif DISTRIBUTION == DISTRIBUTION_LECTURE
    return ggx_distribution_lecture(saturate(dot(n, h)), roughness);
#else
    return ggx_distribution(n, h, ALPHA_OF(roughness));
#endif
}

// Cosines: of n with l and v, [1e-4, 1]; of v with h.
float visibility(float n_dot_l, float n_dot_v, float v_dot_h) {
#if VISIBILITY == VISIBILITY_HEIGHT_CORRELATED_PUSHED
    return visibility_height_correlated_pushed(n_dot_l, n_dot_v, ALPHA_OF(roughness));
#elif VISIBILITY == VISIBILITY_SEPARABLE
    return visibility_separable(n_dot_l, n_dot_v, ALPHA_OF(roughness));
#elif VISIBILITY == VISIBILITY_KARIS_DIRECT
    return visibility_karis_direct(n_dot_l, n_dot_v, saturate(roughness));
#elif VISIBILITY == VISIBILITY_KARIS_IBL
    return visibility_karis_ibl(n_dot_l, n_dot_v, ALPHA_OF(roughness));
#elif VISIBILITY == VISIBILITY_HAMMON
    return visibility_hammon(n_dot_l, n_dot_v, ALPHA_OF(roughness));
#elif VISIBILITY == VISIBILITY_KELEMEN
    return visibility_kelemen(v_dot_h);
#elif VISIBILITY == VISIBILITY_IMPLICIT
    return visibility_implicit();
#elif VISIBILITY == VISIBILITY_LECTURE
    return smith_lecture(n_dot_v, n_dot_l, roughness) / (4.0 * n_dot_v * n_dot_l + 0.001);
#else
    return ggx_visibility(n_dot_l, n_dot_v, ALPHA_OF(roughness));
#endif
}

vec3 fresnel(float v_dot_h, vec3 f0) {
#if FRESNEL == FRESNEL_SCHLICK_POW
    return fresnel_schlick_pow(v_dot_h, f0);
#elif FRESNEL == FRESNEL_SCHLICK_F90
    return fresnel_schlick_f90(v_dot_h, f0, fresnel_edge);
#elif FRESNEL == FRESNEL_SCHLICK_PUSHED
    return fresnel_schlick_pushed(v_dot_h, f0);
#elif FRESNEL == FRESNEL_SPHERICAL_GAUSSIAN
    return fresnel_spherical_gaussian(v_dot_h, f0);
#elif FRESNEL == FRESNEL_F82
    return fresnel_f82(v_dot_h, f0, fresnel_edge);
#elif FRESNEL == FRESNEL_DIELECTRIC
    return vec3(fresnel_dielectric(v_dot_h, ior));
#elif FRESNEL == FRESNEL_CONDUCTOR
    return fresnel_conductor(v_dot_h, eta, k);
#elif FRESNEL == FRESNEL_LECTURE
    return fresnel_schlick_lecture(saturate(v_dot_h), f0);
#else
    return fresnel_schlick(v_dot_h, f0);
#endif
}

// The BRDF times n.l, per steradian.
vec3 reflected(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0) {
    const vec3 h = safe_normalize(v + l, n);
    const float n_dot_l = saturate(dot(n, l));
    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);
    const float v_dot_h = dot(v, h);
    vec3 f = distribution(n, h) * visibility(max(n_dot_l, 1e-4), n_dot_v, v_dot_h) * fresnel(v_dot_h, f0);

#if ENERGY == ENERGY_SCALED
    const vec2 dfg = split_sum_lookup(split_sum_table, n_dot_v, roughness, split_sum_size);
    f *= multiscatter_scale(f0, saturate(dfg.x + dfg.y));
#elif ENERGY == ENERGY_KULLA_CONTY
    const vec2 dfg_v = split_sum_lookup(split_sum_table, n_dot_v, roughness, split_sum_size);
    const vec2 dfg_l = split_sum_lookup(split_sum_table, n_dot_l, roughness, split_sum_size);
    f += multiscatter_lobe(saturate(dfg_l.x + dfg_l.y), saturate(dfg_v.x + dfg_v.y), albedo_average, fresnel_average(f0));
#endif

#if DIFFUSE == DIFFUSE_LAMBERT
    f += diffuse / pi;
#elif DIFFUSE == DIFFUSE_DISNEY
    f += diffuse / pi * disney_diffuse(n_dot_l, n_dot_v, saturate(v_dot_h), saturate(roughness));
#elif DIFFUSE == DIFFUSE_DISNEY_RENORMALISED
    f += diffuse / pi * disney_diffuse_renormalised(n_dot_l, n_dot_v, saturate(v_dot_h), saturate(roughness));
#elif DIFFUSE == DIFFUSE_DISNEY_SUBSURFACE
    f += diffuse / pi * disney_subsurface(n_dot_l, n_dot_v, saturate(v_dot_h), saturate(roughness));
#endif
    return f * n_dot_l;
}

#elif MODEL == MODEL_MERL_NEAREST || MODEL == MODEL_MERL_LINEAR || MODEL == MODEL_MERL_FILTERED

#include "lib/merl.glsl"

vec3 reflected(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0) {
    const vec3 at = merl_coordinates(n, l, safe_normalize(v + l, n));
#if MODEL == MODEL_MERL_NEAREST
    return merl_lookup_nearest(merl_table, at) * saturate(dot(n, l));
#elif MODEL == MODEL_MERL_LINEAR
    return merl_lookup(merl_table, at) * saturate(dot(n, l));
#else
    return merl_lookup_filtered(merl_table, at) * saturate(dot(n, l));
#endif
}

#else

#if MODEL == MODEL_COOK_TORRANCE
#include "lib/cook_torrance.glsl"
#elif MODEL == MODEL_COOK_TORRANCE_HAMMON
#include "lib/cook_torrance_forms.glsl"
#elif MODEL == MODEL_BLINN_PHONG
#include "lib/blinn_phong.glsl"
#elif MODEL == MODEL_BLINN_PHONG_RAW
#include "lib/blinn_phong_raw.glsl"
#elif MODEL == MODEL_DISNEY
#include "lib/disney.glsl"
#else
#include "lib/lecture_brdf.glsl"
#endif

vec3 reflected(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0) {
#if MODEL == MODEL_COOK_TORRANCE
    return cook_torrance(n, v, l, diffuse, f0, roughness);
#elif MODEL == MODEL_COOK_TORRANCE_HAMMON
    return cook_torrance_hammon(n, v, l, diffuse, f0, roughness);
#elif MODEL == MODEL_COOK_TORRANCE_LECTURE
    return cook_torrance_lecture(SpecularGlossiness(f0, diffuse, n, 1.0 - roughness), v, l, 1.0) * saturate(dot(n, l));
#elif MODEL == MODEL_BLINN_PHONG
    return blinn_phong(n, v, l, diffuse, f0, shininess);
#elif MODEL == MODEL_BLINN_PHONG_RAW
    return blinn_phong_raw(n, v, l, diffuse, f0, shininess);
#elif MODEL == MODEL_BLINN_PHONG_LECTURE
    return blinn_phong_lecture(n, v, l, diffuse, f0, shininess);
#else
    return disney_brdf(n, v, l,
                       DisneyMaterial(base_colour, metallic, subsurface, dielectric_specular, roughness, specular_tint, sheen,
                                      sheen_tint, clearcoat, clearcoat_gloss));
#endif
}

#endif

void main() {
    const vec3 n = sphere_normal(screen_uv);
    const vec3 lamp = safe_normalize(lamp_bearing, sphere_viewer) * (2.0 + lamp_height);
    const vec3 l = safe_normalize(lamp - n, n);
    const MetallicRoughness painted = MetallicRoughness(base_colour, n, roughness, metallic);
#if PARAMETERS == PARAMETERS_PUSHED
    const SpecularGlossiness m = metallic_to_specular_pushed(painted, dielectric_specular);
#elif PARAMETERS == PARAMETERS_LECTURE
    const SpecularGlossiness m = metallic_to_specular_lecture(painted, dielectric_specular);
#else
    const SpecularGlossiness m = metallic_to_specular(painted, dielectric_specular);
#endif
    const vec3 radiance = reflected(n, sphere_viewer, l, m.diffuse, m.specular) * (pi * lamp_brightness);
    color = vec4(on_sphere(screen_uv) ? radiance : vec3(0.0), 1.0);
}
