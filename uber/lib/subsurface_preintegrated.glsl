#ifndef KILN_SUBSURFACE_PREINTEGRATED_GLSL
#define KILN_SUBSURFACE_PREINTEGRATED_GLSL
// Diffuse light on a curved surface, integrated over its scattering beforehand: a function of n.l and of the curvature
// (Penner and Borshukov, "Pre-Integrated Skin Shading", GPU Pro 2, 2011).
#include "subsurface.glsl"

#ifndef PREINTEGRATED_STEPS
#define PREINTEGRATED_STEPS 32
#endif

// sin(x) for x in [-pi/2, pi/2] by its series to x^11: relative error below 6e-8.
float preintegrated_sine(float x) {
    const float y = x * x;
    return x * (1.0 - y / 6.0 * (1.0 - y / 20.0 * (1.0 - y / 42.0 * (1.0 - y / 72.0 * (1.0 - y / 110.0)))));
}

// Penner's ring of radius 1/curvature with a Gaussian profile of the variance v:
//   integral of max(0, cos(theta + x)) G(c) dx / integral of G(c) dx,   c = 2 sin(x/2) / curvature, the chord
// by the midpoint rule to 4 standard deviations or once around. The only sine is that of x/2, which stands over sigma: it
// needs the relative precision that sin() does not promise, hence a series, and cos(x), sin(x) follow from it.
// n_dot_l: [-1, 1]; curvature: 1/length, [0, inf); variance: length^2, [0, inf). On a flat surface Lambert's cosine.
float preintegrated_ring(float n_dot_l, float curvature, float variance) {
    const float cosine = clamp(n_dot_l, -1.0, 1.0);
    const float sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    const float sigma = sqrt(variance) * curvature;
    const float reach = 2.0 * sigma < 1.0 ? 2.0 * asin(2.0 * sigma) : pi;
    const float scale = sigma > 0.0 ? 2.0 / (sigma * sigma) : 0.0;
    float sum = 0.0;
    float weights = 0.0;
    for (int i = 0; i < PREINTEGRATED_STEPS; ++i) {
        const float x = reach * ((2.0 * float(i) + 1.0) / float(PREINTEGRATED_STEPS) - 1.0);
        const float t = preintegrated_sine(0.5 * x);
        const float weight = exp(-scale * t * t);
        sum += weight * max(cosine * (1.0 - 2.0 * t * t) - sine * (2.0 * t * sqrt(max((1.0 - t) * (1.0 + t), 0.0))), 0.0);
        weights += weight;
    }
    return sum / weights;
}

// The Gaussian whose mean square distance is that of Burley's profile, 14/s^2 = 2 v.
float burley_gaussian_variance(float s) {
    return 7.0 / (s * s);
}

// The mean of max(0, n.l) around the circle at the angle omega from a point where n.l = cos(theta), on a unit sphere:
// a = cos(theta) cos(omega), b = sin(theta) sin(omega), a + b cos(phi) averaged where it is above 0. Cosines in [-1, 1].
float circle_of_clamped_cosine(float cos_theta, float cos_omega) {
    const float a = cos_theta * cos_omega;
    const float b2 = max((1.0 - cos_theta) * (1.0 + cos_theta), 0.0) * max((1.0 - cos_omega) * (1.0 + cos_omega), 0.0);
    const float root2 = b2 - a * a;
    if (root2 <= 0.0) return max(a, 0.0);
    const float root = sqrt(root2);
    return (a * atan(root, -a) + root) / pi;
}

// The same idea over the whole sphere of radius 1/curvature and with Burley's profile, which a ring cannot take: 1/r along
// a line has no finite integral. Area at the chord c is 2 pi c dc, so steps of equal share of the profile's own
// distribution, cut at the diameter, weigh the same:
//   1/n sum of circle_of_clamped_cosine(n.l, 1 - c^2 curvature^2 / 2)
// n_dot_l: [-1, 1]; curvature_over_s: curvature / s, no unit, [0, 1e6]. The mean over the sphere stays 1/4.
float preintegrated_sphere(float n_dot_l, float curvature_over_s) {
    const float cosine = clamp(n_dot_l, -1.0, 1.0);
    const float k = clamp(curvature_over_s, 1e-6, 1e6);
    const float whole = burley_cumulative(2.0 / k, 1.0);
    float sum = 0.0;
    for (int i = 0; i < PREINTEGRATED_STEPS; ++i) {
        const float u = whole * (float(i) + 0.5) / float(PREINTEGRATED_STEPS);
        const float t = min(burley_radius(u, 1.0) * k, 2.0);
        sum += circle_of_clamped_cosine(cosine, 1.0 - 0.5 * t * t);
    }
    return sum / float(PREINTEGRATED_STEPS);
}

// Where preintegrated_sphere(n_dot_l, k) stands in a table of it, k = curvature / s: uv = ((n.l + 1)/2, k / (1 + k)), from
// the centre of the first texel to that of the last. One table serves every profile: each channel looks up its own s.
// size: of the table in texels, >= 2.
vec2 preintegrated_uv(float n_dot_l, float curvature_over_s, vec2 size) {
    const vec2 t = vec2(0.5 + 0.5 * clamp(n_dot_l, -1.0, 1.0), curvature_over_s / (1.0 + curvature_over_s));
    return (t * (size - 1.0) + 0.5) / size;
}

// What a table holds at a texel; its last row stands for any large curvature, where the profile is
// 1/r alone. texel: [0, size).
float preintegrated_texel(ivec2 texel, ivec2 size) {
    const vec2 t = vec2(texel) / vec2(size - 1);
    const float k = t.y / max(1.0 - t.y, 1e-6);
    return preintegrated_sphere(2.0 * t.x - 1.0, k);
}

// The table looked up for three channels. s: 1/length, (0, inf); curvature: 1/length, [0, inf). table: linear filter,
// clamped, in its red channel; 16 bits or floats, since 8-bit filtering is coarse.
vec3 preintegrated_lookup(sampler2D table, float n_dot_l, float curvature, vec3 s) {
    const vec2 size = vec2(textureSize(table, 0));
    return vec3(textureLod(table, preintegrated_uv(n_dot_l, curvature / s.x, size), 0.0).r,
                textureLod(table, preintegrated_uv(n_dot_l, curvature / s.y, size), 0.0).r,
                textureLod(table, preintegrated_uv(n_dot_l, curvature / s.z, size), 0.0).r);
}

#endif
