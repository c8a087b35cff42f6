#version 450
// What a hair fibre scatters towards the eye, over the directions that light may come from (study_directions.glsl): the forms of lib/.
// The fibre lies along x. manifests/library.yaml names the values.

#define HAIR_CHIANG 0
#define HAIR_CHIANG_WIDTH 1
#define HAIR_KARIS 2
#define HAIR_KAJIYA_KAY 3
#define HAIR_SCHEUERMANN 4
// The first longitudinal lobe alone: gathered so that nothing overflows, and as printed.
#define HAIR_LONGITUDINAL 5
#define HAIR_LONGITUDINAL_PRINTED 6
#define HAIR_LONGITUDINAL_LOG 7

#if HAIR == HAIR_CHIANG_WIDTH
#define HAIR_WIDTH_STEPS 4
#endif
#include "lib/hair.glsl"
#include "lib/hair_cheap.glsl"
#include "lib/math.glsl"
#include "lib/vectors.glsl"
#include "study_directions.glsl"
#if HAIR == HAIR_LONGITUDINAL_PRINTED || HAIR == HAIR_LONGITUDINAL_LOG
#include "lib/hair_published.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Hair {
    vec3 towards_eye;          // in the fibre's frame, need not be of unit length
    float beta_m;              // perceptual roughness along the fibre, limited to [0.2, 1]: what is printed ends below
    vec3 hair_colour;          // of a head of hair, (0, 1]
    float beta_n;              // around the fibre, limited to [0.2, 1]
    vec3 lamp_brightness;      // irradiance across the fibre, >= 0
    float across;              // where the ray to the eye leaves the fibre, [-1, 1]; chiang
    float tilt;                // of the cuticle's scales in tenths of a radian
    float backlit;             // karis: [0, 1]
    float specular_level;      // karis, 0.5 for an index of 1.55; kajiya_kay, scheuermann
    float shininess;           // kajiya_kay, scheuermann: [1, 2048]
};

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: scattered radiance, linear; a: 1

vec3 scattered(vec3 l, vec3 v) {
    const vec3 tangent = vec3(1.0, 0.0, 0.0);
    const float along = clamp(beta_m, 0.2, 1.0);
    const float around = clamp(beta_n, 0.2, 1.0);
#if HAIR == HAIR_KARIS
    return hair_karis(tangent, l, v, hair_colour, along, specular_level, backlit);
#elif HAIR == HAIR_KAJIYA_KAY
    return hair_kajiya_kay(tangent, l, v, hair_colour / pi, vec3(specular_level), shininess);
#elif HAIR == HAIR_SCHEUERMANN
    const float sine = sqrt(saturate((1.0 - l.x) * (1.0 + l.x)));
    return hair_colour / pi * sine + vec3(specular_level * hair_scheuermann(tangent, l, v, shininess));
#elif HAIR == HAIR_CHIANG || HAIR == HAIR_CHIANG_WIDTH
    const HairFibre fibre = HairFibre(hair_absorption(hair_colour, around), 1.55, along, around, 0.1 * tilt);
#if HAIR == HAIR_CHIANG
    return hair_chiang(fibre, l, v, across);
#else
    return hair_chiang_width(fibre, l, v);
#endif
#else
    const float variance = hair_variance(0, along);
    const float cosine_l = length(l.yz);
    const float cosine_v = length(v.yz);
#if HAIR == HAIR_LONGITUDINAL_PRINTED
    return vec3(hair_longitudinal_printed(l.x, cosine_l, v.x, cosine_v, variance));
#elif HAIR == HAIR_LONGITUDINAL_LOG
    return vec3(hair_longitudinal_log(l.x, cosine_l, v.x, cosine_v, variance));
#else
    return vec3(hair_longitudinal(l.x, cosine_l, v.x, cosine_v, variance));
#endif
#endif
}

void main() {
    const vec3 v = safe_normalize(towards_eye, vec3(0.0, 0.0, 1.0));
    color = vec4(scattered(square_direction(screen_uv), v) * lamp_brightness, 1.0);
}
