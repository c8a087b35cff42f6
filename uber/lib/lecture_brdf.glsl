#ifndef KILN_LECTURE_BRDF_GLSL
#define KILN_LECTURE_BRDF_GLSL
// The reflectance code of GAMES104 lecture 05 as printed, wrong as it is, to show what its slips cost. Nothing here is a
// default: ggx.glsl, fresnel.glsl, cook_torrance.glsl, blinn_phong.glsl and material_models.glsl are right.
//
// Mended only so far that it compiles as GLSL, and each mend is named at its place. `float3` reads vec3 and `lerp` mix, as
// HLSL is no GLSL. `precise` stands on results so that a failure is the formula's own: without it a compiler may
// rearrange the terms, and the same text then gives inf or a finite wrong value by what stands beside it.
#include "material_models.glsl"
#include "math.glsl"

// D. Takes `roughness` for alpha, although the formula beside it says alpha: with the caller below the lobe is that of
// alpha = roughness, and its peak lower by roughness^2. inf for n.h = 1 and alpha up to 1.7e-4, NaN for alpha 0.
float ggx_distribution_lecture(float NoH, float roughness) {
    precise float a2 = roughness * roughness;
    precise float f = (NoH * NoH) * (a2 - 1.0) + 1.0;
    precise float d = a2 / (pi * f * f);
    return d;
}

float smith_g1_lecture(float NdotV, float k) {
    precise float g = NdotV / (NdotV * (1.0 - k) + k);
    return g;
}

// G. The k of analytic lights, whatever the light.
float smith_lecture(float NdotV, float NdotL, float roughness) {
    precise float k = pow(roughness + 1.0, 2.0) / 8.0;
    return smith_g1_lecture(NdotL, k) * smith_g1_lecture(NdotV, k);
}

// F. NaN for a VoH that has rounded above 1.
float fresnel_schlick_lecture(float VoH, float f0) {
    precise float f = pow(1.0 - VoH, 5.0);
    precise float F = f0 + (1.0 - f0) * f;
    return F;
}

// Mend: the lecture's caller passes a float3 f0 to the function above and takes a float3 from it.
vec3 fresnel_schlick_lecture(float VoH, vec3 f0) {
    return vec3(fresnel_schlick_lecture(VoH, f0.x), fresnel_schlick_lecture(VoH, f0.y), fresnel_schlick_lecture(VoH, f0.z));
}

// The specular term with its padded denominator, 2.4 % too dark where both cosines are 0.1 and 71 % where they are 0.01.
vec3 specular_lecture(float N_dot_L, float N_dot_V, float N_dot_H, float V_dot_H, vec3 F0, float roughness) {
    precise float D = ggx_distribution_lecture(N_dot_H, roughness);
    precise vec3 F = fresnel_schlick_lecture(V_dot_H, F0);
    precise float G = smith_lecture(N_dot_V, N_dot_L, roughness);
    precise float denominator = 4.0 * N_dot_V * N_dot_L + 0.001;    // mend: `;` was missing
    precise vec3 specular = (D * F * G) / denominator;
    return specular;
}

// calculateBRDF. Mends: view_direction, light_direction and k_d, which are declared nowhere, are arguments; N_dot_H and
// V_dot_H, declared float3 for scalar values, are float.
vec3 cook_torrance_lecture(SpecularGlossiness specular_glossiness, vec3 view_direction, vec3 light_direction, float k_d) {
    precise vec3 half_vector = normalize(view_direction + light_direction);
    float N_dot_L = saturate(dot(specular_glossiness.normal, light_direction));
    float N_dot_V = abs(dot(specular_glossiness.normal, view_direction));
    float N_dot_H = saturate(dot(specular_glossiness.normal, half_vector));
    float V_dot_H = saturate(dot(view_direction, half_vector));

    // diffuse
    vec3 diffuse = k_d * specular_glossiness.diffuse / pi;

    // specular
    float roughness = 1.0 - specular_glossiness.glossiness;
    vec3 F0 = specular_glossiness.specular;
    vec3 specular = specular_lecture(N_dot_L, N_dot_V, N_dot_H, V_dot_H, F0, roughness);

    // brdf
    return diffuse + specular;
}

// ConvertMetallicRoughnessToSpecularGlossiness. Mends: dielectricSpecular, declared nowhere, is an argument; what is
// returned is specular_glossiness, where `result` is declared nowhere; the normal, never assigned, is 0 here, as reading
// what was never written has no meaning.
SpecularGlossiness metallic_to_specular_lecture(MetallicRoughness metallic_roughness, float dielectricSpecular) {
    vec3 base_color = metallic_roughness.base_color;
    float roughness = metallic_roughness.roughness;
    float metallic = metallic_roughness.metallic;

    vec3 dielectricSpecularColor = vec3(0.08 * dielectricSpecular);
    vec3 specular = mix(dielectricSpecularColor, base_color, metallic);
    vec3 diffuse = base_color - base_color * metallic;

    SpecularGlossiness specular_glossiness;
    specular_glossiness.specular = specular;
    specular_glossiness.diffuse = diffuse;
    specular_glossiness.normal = vec3(0.0);
    specular_glossiness.glossiness = 1.0 - roughness;
    return specular_glossiness;
}

// kd max(0, n.l) + ks max(0, n.h)^p, the factor on I / r^2 (the formula has no code). No gate: the highlight shines
// through from behind; no normalisation, no 1 / pi; 0^0 for p = 0 is whatever the device makes of it.
vec3 blinn_phong_lecture(vec3 n, vec3 v, vec3 l, vec3 kd, vec3 ks, float p) {
    precise vec3 h = normalize(v + l);
    return kd * max(0.0, dot(n, l)) + ks * pow(max(0.0, dot(n, h)), p);
}

#endif
