// What a surface reflects of one light. The lecture's forms stand beside the others as points of comparison.

#if MATERIAL == MATERIAL_BLINN_PHONG
#include "lib/blinn_phong.glsl"
#elif MATERIAL == MATERIAL_BLINN_PHONG_RAW
#include "lib/blinn_phong_raw.glsl"
#elif MATERIAL == MATERIAL_DISNEY
#include "lib/disney.glsl"
#elif MATERIAL == MATERIAL_BLINN_PHONG_LECTURE || MATERIAL == MATERIAL_PBR_LECTURE
#include "lib/lecture_brdf.glsl"
#elif GEOMETRY == GEOMETRY_HAMMON
#include "lib/cook_torrance_forms.glsl"
#else
#include "lib/cook_torrance.glsl"
#endif

// The BRDF times n.l, per steradian. n, v, l: unit vectors from the surface.
vec3 reflected_light(vec3 n, vec3 v, vec3 l, Shading s) {
#if MATERIAL == MATERIAL_BLINN_PHONG
    return blinn_phong(n, v, l, s.diffuse, s.specular, shininess);
#elif MATERIAL == MATERIAL_BLINN_PHONG_RAW
    return blinn_phong_raw(n, v, l, s.diffuse, s.specular, shininess);
#elif MATERIAL == MATERIAL_BLINN_PHONG_LECTURE
    return blinn_phong_lecture(n, v, l, s.diffuse, s.specular, shininess);
#elif MATERIAL == MATERIAL_DISNEY
    return disney_brdf(n, v, l,
                       DisneyMaterial(s.base, s.metallic, disney_subsurface_share, disney_specular_level, s.roughness,
                                      disney_specular_tint, disney_sheen, disney_sheen_tint, disney_coat, disney_coat_gloss));
#elif MATERIAL == MATERIAL_PBR_LECTURE
    SpecularGlossiness material;
    material.specular = s.specular;
    material.diffuse = s.diffuse;
    material.normal = n;
    material.glossiness = 1.0 - s.roughness;
    return cook_torrance_lecture(material, v, l, 1.0) * saturate(dot(n, l));
#elif GEOMETRY == GEOMETRY_HAMMON
    return cook_torrance_hammon(n, v, l, s.diffuse, s.specular, s.roughness);
#else
    return cook_torrance(n, v, l, s.diffuse, s.specular, s.roughness);
#endif
}
