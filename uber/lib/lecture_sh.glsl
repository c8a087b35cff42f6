#ifndef KILN_LECTURE_SH_GLSL
#define KILN_LECTURE_SH_GLSL
// The SH listings of GAMES104 lecture 05 as printed, with their six-digit constants, and the naive reading of them: basis
// constants in the bake, `shApplyDiffuseConvolutionL1` on the result, and basis constants again when shading. Each of the
// two factors of the convolution already contains one basis constant, so that a furnace of radiance 1 shades 0.886227 in
// place of 3.141593, and the direction weighs sqrt(3) too much. A point of comparison, never a default.

// shEvaluateL1: coefficients of a light of unit strength from direction p, or the weights to read with. p: unit vector.
vec4 sh_evaluate_l1_lecture(vec3 p) {
    const float y0 = 0.282095;
    const float y1 = 0.488603;
    return vec4(y0, y1 * p.y, y1 * p.z, y1 * p.x);
}

// shApplyDiffuseConvolutionL1: sqrt(pi)/2 and sqrt(pi/3), the second cut off after its sixth digit.
vec4 sh_apply_diffuse_convolution_l1_lecture(vec4 sh) {
    const float a0 = 0.886227;
    const float a1 = 1.023326;
    return vec4(sh.x * a0, sh.yzw * a1);
}

// shEvaluateDiffuseL1: the two above merged, 0.25 and 0.5 (right only for raw moments, or raw weights).
vec4 sh_evaluate_diffuse_l1_lecture(vec3 p) {
    const float ay0 = 0.25;
    const float ay1 = 0.5;
    return vec4(ay0, ay1 * p.y, ay1 * p.z, ay1 * p.x);
}

// One channel of "irradiance" as the slides read in order. c: orthonormal coefficients of radiance; n: unit vector.
float sh_irradiance_lecture(vec4 c, vec3 n) {
    return dot(sh_apply_diffuse_convolution_l1_lecture(c), sh_evaluate_l1_lecture(n));
}

#endif
