// What a surface is, sampled once for the BRDFs and the g-buffer.

#include "lib/materials.glsl"
#if MATERIAL == MATERIAL_BLINN_PHONG
#include "lib/blinn_phong.glsl"
#elif MATERIAL == MATERIAL_PBR_LECTURE
#include "lib/lecture_brdf.glsl"
#endif
#if NORMAL_MAP
#include "lib/normal_map.glsl"
#endif

layout(set = 1, binding = 1) uniform sampler2D base_map;         // sRGB; diffuse, for pbr_mr and disney base colour
layout(set = 1, binding = 2) uniform sampler2D specular_map;     // sRGB; blinn_phong: ks, pbr_sg: F0
layout(set = 1, binding = 3) uniform sampler2D gloss_map;        // linear r; pbr_sg
layout(set = 1, binding = 4) uniform sampler2D roughness_map;    // linear r; pbr_mr, disney
layout(set = 1, binding = 5) uniform sampler2D metallic_map;     // linear r; pbr_mr, disney
#if NORMAL_MAP
layout(set = 1, binding = 6) uniform sampler2D normal_map;       // linear, tangent space, 128 is 0
#endif
#if MATERIAL == MATERIAL_DISNEY
layout(std140, set = 1, binding = 7) uniform Disney {            // all [0, 1]
    float disney_subsurface_share;
    float disney_specular_level;
    float disney_specular_tint;
    float disney_sheen;
    float disney_sheen_tint;
    float disney_coat;
    float disney_coat_gloss;
};
#endif

struct Shading {
    MEDIUM vec3 diffuse;       // [0, 1]
    MEDIUM vec3 specular;      // F0, for Blinn-Phong ks; [0, 1]
    MEDIUM float roughness;    // perceptual, [0, 1]
#if MATERIAL == MATERIAL_DISNEY
    vec3 base;                 // [0, 1]
    float metallic;            // [0, 1]
#endif
};

Shading sample_material() {
    Shading s;
    MEDIUM const vec3 base = reflectance(texture(base_map, material_uv).rgb, base_factor.rgb);
#if MATERIAL == MATERIAL_PBR_MR || MATERIAL == MATERIAL_DISNEY || MATERIAL == MATERIAL_PBR_LECTURE
    MEDIUM const float metallic = texture(metallic_map, material_uv).r * metallic_factor;
    s.roughness = saturate(texture(roughness_map, material_uv).r * roughness_factor);
#if MATERIAL == MATERIAL_PBR_LECTURE
    const SpecularGlossiness converted =
        metallic_to_specular_lecture(MetallicRoughness(base, vec3(0.0), s.roughness, metallic), dielectric_specular);
    s.diffuse = converted.diffuse;
    s.specular = converted.specular;
#else
    s.diffuse = metallic_diffuse(base, metallic);
    s.specular = metallic_f0(base, metallic, dielectric_specular);
#endif
#if MATERIAL == MATERIAL_DISNEY
    s.base = base;
    s.metallic = saturate(metallic);
#endif
#else
    s.diffuse = base;
    s.specular = reflectance(texture(specular_map, material_uv).rgb, specular_factor.rgb);
#if MATERIAL == MATERIAL_PBR_SG
    s.roughness = 1.0 - saturate(texture(gloss_map, material_uv).r * glossiness_factor);
#elif MATERIAL == MATERIAL_BLINN_PHONG
    s.roughness = blinn_phong_roughness(clamp(shininess, 1.0, 2048.0));
#else
    s.roughness = 1.0;
#endif
#endif
    return s;
}

// Towards the side that is seen, where both sides are drawn.
vec3 faced(vec3 n) {
#if TWO_SIDED
    return gl_FrontFacing ? n : -n;
#else
    return n;
#endif
}

// Of the surface as it stands in shadow maps: a normal map moves no depth.
vec3 geometric_normal() {
    return faced(safe_normalize(world_normal, vec3(0.0, 0.0, 1.0)));
}

vec3 shading_normal() {
    vec3 n = safe_normalize(world_normal, vec3(0.0, 0.0, 1.0));
#if NORMAL_MAP
    const mat3 frame = tangent_frame(n, world_tangent.xyz, world_tangent.w);
    n = apply_normal(frame, decode_normal_unorm8(texture(normal_map, material_uv).xyz));
#endif
    return faced(n);
}
