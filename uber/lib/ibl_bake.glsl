#ifndef KILN_IBL_BAKE_GLSL
#define KILN_IBL_BAKE_GLSL
// Integrals over an environment and over a GGX lobe by samples: what the tables of ibl.glsl are baked with, and, with the
// view as it is, the truth that they approximate. Conventions as there. Sample counts are limited to 65536.
#include "environment.glsl"
#include "fresnel.glsl"
#include "ggx.glsl"
#include "math.glsl"

const uint ibl_most_samples = 65536u;

// Bits in reverse order behind the binary point: van der Corput's sequence. 24 bits, so that it stays below 1 in fp32.
float radical_inverse(uint i) {
    uint b = (i << 16u) | (i >> 16u);
    b = ((b & 0x55555555u) << 1u) | ((b & 0xaaaaaaaau) >> 1u);
    b = ((b & 0x33333333u) << 2u) | ((b & 0xccccccccu) >> 2u);
    b = ((b & 0x0f0f0f0fu) << 4u) | ((b & 0xf0f0f0f0u) >> 4u);
    b = ((b & 0x00ff00ffu) << 8u) | ((b & 0xff00ff00u) >> 8u);
    return float(b >> 8u) * (1.0 / 16777216.0);
}

// Point i of Hammersley's set of `count`, in [0, 1)^2. i: [0, count); count: >= 1. i / count, not (i + 1/2) / count: for the
// split sum, whose lobe is cut by the horizon, the latter is two to three times worse.
vec2 hammersley(uint i, uint count) {
    return vec2(float(i) / float(count), radical_inverse(i));
}

// A right-handed frame with n as its third column, continuous but at n.z = 0. Duff et al., "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017. n: unit vector.
mat3 frame_around(vec3 n) {
    const float s = n.z < 0.0 ? -1.0 : 1.0;
    const float a = -1.0 / (s + n.z);
    const float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// A direction around +z with density cos / pi. u: [0, 1)^2.
vec3 sample_cosine(vec2 u) {
    const float r = sqrt(u.x);
    return vec3(-r * cos_sin_of_turn(u.y), sqrt(max(1.0 - u.x, 0.0)));
}

// A half vector around +z with density D n.h:  tan^2 theta = a^2 u / (1 - u)  (Walter et al. 2007, equation 35). From the
// tangent: 1 - cos^2 would cancel. u: [0, 1)^2; alpha: (0, 1].
vec3 sample_ggx_half(vec2 u, float alpha) {
    const float tangent = alpha * sqrt(u.x / max(1.0 - u.x, 1e-7));
    const float cosine = inversesqrt(1.0 + tangent * tangent);
    const float sine = tangent * cosine;
    return vec3(-sine * cos_sin_of_turn(u.y), cosine);
}

// The mip whose texels are as large as a sample's share of the sphere: 0.5 log2(ws / wp), ws = 1 / (count pdf) and
// wp = 4 pi / (6 size^2). Colbert and Krivanek, "GPU-Based Importance Sampling", GPU Gems 3, 2007. pdf: per steradian, > 0;
// size: texels a side of the map's level 0. At least 0.
float filtered_lod(float pdf, float count, float size) {
    return max(0.5 * log2(6.0 * size * size / (4.0 * pi * count * max(pdf, 1e-20))), 0.0);
}

// E(n) / pi from `count` samples spread by the cosine; `filtered` reads each at its mip. n: unit vector.
vec3 irradiance_sampled(samplerCube map, vec3 n, uint count, bool filtered) {
    const uint samples = clamp(count, 1u, ibl_most_samples);
    const float size = float(textureSize(map, 0).x);
    const mat3 frame = frame_around(n);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < samples; ++i) {
        const vec3 l = sample_cosine(hammersley(i, samples));
        const float lod = filtered ? filtered_lod(l.z / pi, float(samples), size) : 0.0;
        sum += textureLod(map, frame * l, lod).rgb;
    }
    return sum / float(samples);
}

// E(n) / pi as a sum over all texels of a level: nothing is missed, the sums over L and over 1 have the same weights, so that
// a constant map comes out exact. The error of a smooth map falls with the square of `size`. n: unit vector.
vec3 irradiance_summed(samplerCube map, vec3 n, int level) {
    const int size = textureSize(map, level).x;
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < size; ++y) {
            vec3 row = vec3(0.0);
            float row_weights = 0.0;
            for (int x = 0; x < size; ++x) {
                const vec2 p = cube_texel_centre(ivec2(x, y), size);
                const vec3 d = cube_direction(face, p);
                const float d2 = dot(d, d);
                const float weight = max(dot(n, d), 0.0) / (d2 * d2);
                row += textureLod(map, d, float(level)).rgb * weight;
                row_weights += weight;
            }
            sum += row;
            weights += row_weights;
        }
    }
    return sum / max(weights, 1e-20);
}

// One texel of the prefiltered map, N = V = R = n: the mean of L over the lobe's reflections, weighted by n.l,
//   sum L(l) n.l / sum n.l,   l = reflect(-n, h),   h by sample_ggx_half        (Karis 2013)
// A constant map comes out exact at every roughness. n: unit vector; alpha: (0, 1].
vec3 prefilter_sampled(samplerCube map, vec3 n, float alpha, uint count, bool filtered) {
    const uint samples = clamp(count, 1u, ibl_most_samples);
    const float size = float(textureSize(map, 0).x);
    const mat3 frame = frame_around(n);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (uint i = 0u; i < samples; ++i) {
        const vec3 h = sample_ggx_half(hammersley(i, samples), alpha);
        const vec3 l = vec3(2.0 * h.z * h.xy, 2.0 * h.z * h.z - 1.0);
        if (l.z > 0.0) {
            // The density of l is D n.h / (4 v.h), and v.h = n.h here.
            const float pdf = 0.25 * ggx_distribution(vec3(0.0, 0.0, 1.0), h, alpha);
            const float lod = filtered ? filtered_lod(pdf, float(samples), size) : 0.0;
            sum += textureLod(map, frame * l, lod).rgb * l.z;
            weights += l.z;
        }
    }
    return sum / max(weights, 1e-20);
}

// The same as a sum over all texels of a level, weighted by D n.l and their solid angles: for lobes of many texels only
// (alpha above 4 / size).
vec3 prefilter_summed(samplerCube map, vec3 n, float alpha, int level) {
    const int size = textureSize(map, level).x;
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < size; ++y) {
            vec3 row = vec3(0.0);
            float row_weights = 0.0;
            for (int x = 0; x < size; ++x) {
                const vec2 p = cube_texel_centre(ivec2(x, y), size);
                const vec3 l = normalize(cube_direction(face, p));
                const float n_dot_l = max(dot(n, l), 0.0);
                const vec3 h = normalize(n + l * (n_dot_l > 0.0 ? 1.0 : 0.0));
                const float weight = n_dot_l * ggx_distribution(n, h, alpha) * cube_texel_solid_angle(p, float(size));
                row += textureLod(map, l, float(level)).rgb * weight;
                row_weights += weight;
            }
            sum += row;
            weights += row_weights;
        }
    }
    return sum / max(weights, 1e-20);
}

// One texel of the split-sum table, height-correlated Smith:
//   A = mean of 4 V n.l v.h / n.h (1 - Fc),   B = mean of 4 V n.l v.h / n.h Fc,   Fc = (1 - v.h)^5
// over h by sample_ggx_half; V = G2 / (4 n.l n.v) fused. n_dot_v: held in [1e-4, 1]; alpha: (0, 1].
vec2 split_sum_sampled(float n_dot_v, float alpha, uint count) {
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
            const float x = 1.0 - saturate(v_dot_h);
            const float x2 = x * x;
            const float fc = x2 * x2 * x;
            sum += weight * vec2(1.0 - fc, fc);
        }
    }
    return sum / float(samples);
}

// The same with the geometry term of Karis 2013 for image-based light, k = alpha / 2:
//   V = 1 / (4 (n.l (1 - k) + k) (n.v (1 - k) + k))
vec2 split_sum_sampled_karis(float n_dot_v, float alpha, uint count) {
    const uint samples = clamp(count, 1u, ibl_most_samples);
    const float cosine = clamp(n_dot_v, 1e-4, 1.0);
    const float k = 0.5 * alpha;
    const vec3 v = vec3(sqrt(1.0 - cosine * cosine), 0.0, cosine);
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < samples; ++i) {
        const vec3 h = sample_ggx_half(hammersley(i, samples), alpha);
        const float v_dot_h = dot(v, h);
        const float n_dot_l = 2.0 * v_dot_h * h.z - cosine;
        if (n_dot_l > 0.0) {
            const float smith = (n_dot_l * (1.0 - k) + k) * (cosine * (1.0 - k) + k);
            const float weight = n_dot_l * v_dot_h / (h.z * smith);
            const float x = 1.0 - saturate(v_dot_h);
            const float x2 = x * x;
            const float fc = x2 * x2 * x;
            sum += weight * vec2(1.0 - fc, fc);
        }
    }
    return sum / float(samples);
}

// Radiance that a GGX coat reflects to v, without the split: the mean of L 4 V n.l v.h / n.h F(v.h) over half vectors. The
// truth for image_based_light's specular part, with enough samples. n, v: unit vectors; f0: [0, 1]; alpha: (0, 1].
vec3 environment_specular_sampled(samplerCube map, vec3 n, vec3 v, vec3 f0, float alpha, uint count, bool filtered) {
    const uint samples = clamp(count, 1u, ibl_most_samples);
    const float size = float(textureSize(map, 0).x);
    const mat3 frame = frame_around(n);
    const vec3 local = v * frame;
    const float n_dot_v = max(local.z, 1e-4);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < samples; ++i) {
        const vec3 h = sample_ggx_half(hammersley(i, samples), alpha);
        const float v_dot_h = dot(local, h);
        const vec3 l = 2.0 * v_dot_h * h - local;
        if (l.z > 0.0 && v_dot_h > 0.0) {
            const float pdf = ggx_distribution(vec3(0.0, 0.0, 1.0), h, alpha) * h.z / (4.0 * v_dot_h);
            const float lod = filtered ? filtered_lod(pdf, float(samples), size) : 0.0;
            const float weight = 4.0 * ggx_visibility(l.z, n_dot_v, alpha) * l.z * v_dot_h / h.z;
            sum += textureLod(map, frame * l, lod).rgb * fresnel_schlick(v_dot_h, f0) * weight;
        }
    }
    return sum / float(samples);
}

#endif
