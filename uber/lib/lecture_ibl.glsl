#ifndef KILN_LECTURE_IBL_GLSL
#define KILN_LECTURE_IBL_GLSL
// The split sum of GAMES104 lecture 05 as printed: its Fresnel weight is (1 - cos theta_i)^5, of the light's angle to the
// normal, where Schlick's is of its angle to the half vector. At F0 = 0.04 the lobe's albedo comes out 57 % too large at
// roughness 0.5, n.v 0.5, and 103 % at roughness 1, n.v 0.1. A point of comparison, never a default.
#include "ibl_bake.glsl"

// split_sum_sampled with that weight.
vec2 split_sum_sampled_lecture(float n_dot_v, float alpha, uint count) {
    const uint samples = clamp(count, 1u, ibl_most_samples);
    const float cosine = clamp(n_dot_v, 1e-4, 1.0);
    const vec3 v = vec3(sqrt(1.0 - cosine * cosine), 0.0, cosine);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < samples; ++i) {
        const vec3 h = sample_ggx_half(hammersley(i, samples), alpha);
        const float v_dot_h = dot(v, h);
        const float n_dot_l = 2.0 * v_dot_h * h.z - cosine;
        if (n_dot_l > 0.0) {
            const float weight = 4.0 * ggx_visibility(n_dot_l, cosine, alpha) * n_dot_l * v_dot_h / h.z;
            const float fc = pow(1.0 - min(n_dot_l, 1.0), 5.0);
            sum += weight * vec2(1.0 - fc, fc);
        }
    }
    return sum / float(samples);
}

#endif
