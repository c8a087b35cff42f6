#ifndef KILN_HAIR_CHEAP_GLSL
#define KILN_HAIR_CHEAP_GLSL
// Hair in real time: Kajiya and Kay's lobes and Karis' fits of Marschner's. The tangent points from root to tip;
// to_light and to_eye point away from the fibre; all are unit vectors in one space, any.
#include "math.glsl"

// Kajiya and Kay, "Rendering Fur with Three Dimensional Textures", SIGGRAPH 1989:
//   diffuse sin(t, l) + specular (sin(t, l) sin(t, v) - (t.l)(t.v))^p
// The bracket is the cosine between v and the cone that l is mirrored into. Keeps no energy: p gives no normalisation and
// the diffuse term reflects up to pi^2 diffuse. It is what S of hair.glsl is: no further cosine belongs to it.
// diffuse, specular: [0, 1]; exponent: [1, 2048].
vec3 hair_kajiya_kay(vec3 tangent, vec3 to_light, vec3 to_eye, vec3 diffuse, vec3 specular, float exponent) {
    const float tl = clamp(dot(tangent, to_light), -1.0, 1.0);
    const float tv = clamp(dot(tangent, to_eye), -1.0, 1.0);
    const float sine_l = sqrt((1.0 - tl) * (1.0 + tl));
    const float sine_v = sqrt((1.0 - tv) * (1.0 + tv));
    const float cone = clamp(sine_l * sine_v - tl * tv, 0.0, 1.0);
    return diffuse * sine_l + specular * (cone > 0.0 ? pow(cone, exponent) : 0.0);
}

// The lobe over the half vector, sin(t, h)^p = (1 - (t.h)^2)^(p/2) (Scheuermann, "Practical Real-Time Hair Rendering and
// Shading", SIGGRAPH 2004). With l = -v there is no half vector and no lobe. exponent: [1, 2048].
float hair_scheuermann(vec3 tangent, vec3 to_light, vec3 to_eye, float exponent) {
    const vec3 h = to_light + to_eye;
    const float square = dot(h, h);
    const float th = dot(tangent, h) * inversesqrt(max(square, 1e-12));
    const float sine2 = clamp((1.0 - th) * (1.0 + th), 0.0, 1.0);
    return square > 1e-12 && sine2 > 0.0 ? pow(sine2, 0.5 * exponent) : 0.0;
}

// exp(-x^2 / (2 b^2)) / (sqrt(2 pi) b). x: any; b: (1e-6, inf).
float hair_gaussian(float x, float b) {
    const float t = x / b;
    return exp(-0.5 * t * t) * 0.3989422804 / b;
}

// Schlick's Fresnel for eta = 1.55, F0 = ((1 - eta) / (1 + eta))^2. cosine: [0, 1].
float hair_schlick(float cosine) {
    const float f0 = 0.0465205690;
    const float x = 1.0 - saturate(cosine);
    const float x2 = x * x;
    return f0 + (1.0 - f0) * (x2 * x2 * x);
}

// Karis, "Physically Based Hair Shading in Unreal", SIGGRAPH 2016 course: R, TT and TRT with Gaussians in sin(theta) and
// fits for what is azimuthal, eta = 1.55. The result is what S of hair.glsl is.
// colour: of the fibre, [0, 1]; roughness: [1/255, 1]; specular: [0, 1], 0.5 for 1.55; backlit: [0, 1].
// As published R divides by cos(phi/2) in its Gaussian and multiplies by it in Np: the two are cancelled here, so that
// light from straight behind, phi = pi, is 0 where it was 0/0; and 1/n' is c / (1.19 + 0.36 c^2), finite for c = 0.
vec3 hair_karis(vec3 tangent, vec3 to_light, vec3 to_eye, vec3 colour, float roughness, float specular, float backlit) {
    const float sine_l = -clamp(dot(tangent, to_light), -1.0, 1.0);
    const float sine_v = -clamp(dot(tangent, to_eye), -1.0, 1.0);
    const float cos2_l = (1.0 - sine_l) * (1.0 + sine_l);
    const float cos2_v = (1.0 - sine_v) * (1.0 + sine_v);
    const float both = sqrt(cos2_l * cos2_v);
    const float v_dot_l = dot(to_eye, to_light);
    const float cos_theta_d = max(sqrt(saturate(0.5 + 0.5 * (both + sine_l * sine_v))), 1e-3);
    const float cos_phi = clamp((v_dot_l - sine_l * sine_v) / max(both, 1e-6), -1.0, 1.0);
    const float half_phi = sqrt(saturate(0.5 + 0.5 * cos_phi));

    const float r = clamp(roughness, 1.0 / 255.0, 1.0);
    const float b = r * r;
    const float along = sine_l + sine_v;
    const float shift = 0.035;

    // R: Gaussian of width sqrt(2) b cos(phi/2) times cos(phi/2) / 4.
    const float sa = sin(-2.0 * shift);
    const float ca = cos(-2.0 * shift);
    const float x = along - 2.0 * sa * (ca * half_phi * sqrt(cos2_v) + sa * sine_v);
    const float width = 2.0 * b * half_phi;
    const float lobe_r = half_phi > 0.0 ? exp(-x * x / max(width * width, 1e-30)) * (0.25 * 0.2820947918) / b : 0.0;
    const float behind = mix(1.0, backlit, saturate(-v_dot_l));
    vec3 sum = vec3(lobe_r * hair_schlick(sqrt(saturate(0.5 + 0.5 * v_dot_l))) * (2.0 * specular) * behind);

    // TT
    const float a = cos_theta_d / (1.19 + 0.36 * cos_theta_d * cos_theta_d);
    const float h = half_phi * (1.0 + a * (0.6 - 0.8 * cos_phi));
    const float f_tt = 1.0 - hair_schlick(cos_theta_d * sqrt(saturate(1.0 - h * h)));
    const vec3 base = clamp(colour, vec3(1e-6), vec3(1.0));
    const vec3 t_tt = pow(base, vec3(0.5 * sqrt(saturate(1.0 - h * a * h * a)) / cos_theta_d));
    sum += t_tt * (hair_gaussian(along - shift, 0.5 * b) * exp(-3.65 * cos_phi - 3.98) * f_tt * f_tt * backlit);

    // TRT
    const float f = hair_schlick(0.5 * cos_theta_d);
    const vec3 t_trt = pow(base, vec3(0.8 / cos_theta_d));
    return sum + t_trt * (hair_gaussian(along - 4.0 * shift, 2.0 * b) * exp(17.0 * cos_phi - 16.78) * (1.0 - f) * (1.0 - f) * f);
}

#endif
