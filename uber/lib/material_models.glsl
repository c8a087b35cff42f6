#ifndef KILN_MATERIAL_MODELS_GLSL
#define KILN_MATERIAL_MODELS_GLSL
// Metallic-roughness and specular-glossiness as values, the way from one to the other, and what happens to parameters
// outside [0, 1]: by default they are limited, the *_pushed forms let them through as far as results stay finite and not
// negative ("parameters should be allowed to be pushed beyond their plausible range", Burley 2012).
#include "materials.glsl"
#include "math.glsl"

struct MetallicRoughness {
    vec3 base_color;    // linear
    vec3 normal;        // tangent or world space, whichever the caller uses
    float roughness;    // perceptual
    float metallic;
};

struct SpecularGlossiness {
    vec3 specular;      // reflectance at normal incidence, linear
    vec3 diffuse;       // linear
    vec3 normal;
    float glossiness;   // 1 - roughness
};

// Metallic-roughness as the specular-glossiness material that shades the same, exactly; the way back needs a solve.
// dielectric_specular: f0 of a dielectric in units of 0.08. All parameters are limited to [0, 1] here.
SpecularGlossiness metallic_to_specular(MetallicRoughness m, float dielectric_specular) {
    const vec3 base = clamp(m.base_color, vec3(0.0), vec3(1.0));
    SpecularGlossiness s;
    s.specular = metallic_f0(base, m.metallic, dielectric_specular);
    s.diffuse = metallic_diffuse(base, m.metallic);
    s.normal = m.normal;
    s.glossiness = 1.0 - saturate(m.roughness);
    return s;
}

// The same for parameters outside [0, 1], results not negative: metallic 2 makes specular leave the segment between
// dielectric and base; diffuse, which would turn negative, ends at 0. Parameters: finite, |x| <= 1e6.
SpecularGlossiness metallic_to_specular_pushed(MetallicRoughness m, float dielectric_specular) {
    const vec3 dielectric = vec3(0.08 * dielectric_specular);
    SpecularGlossiness s;
    s.specular = max(mix(dielectric, m.base_color, m.metallic), vec3(0.0));
    s.diffuse = max(m.base_color * (1.0 - m.metallic), vec3(0.0));
    s.normal = m.normal;
    s.glossiness = 1.0 - m.roughness;
    return s;
}

// alpha of a perceptual roughness that may exceed 1, up to 4 (alpha 16), where D is below 1 / pi at its peak and grows
// towards grazing. roughness: any finite.
float ggx_alpha_pushed(float roughness) {
    const float r = clamp(roughness, 0.045, 4.0);
    return r * r;
}

#endif
