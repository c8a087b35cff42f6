#ifndef KILN_LECTURE_SHADOW_GLSL
#define KILN_LECTURE_SHADOW_GLSL
// Shadows as GAMES104 lecture 05 prints them, for tests that show what goes wrong and for *_LECTURE axis values. Use
// shadow_map.glsl, cascades.glsl, pcss.glsl and vsm.glsl.

// Slide "Shadow Map". Depth is remapped from [-1, 1] as OpenGL has it: under Vulkan's [0, 1] the receiver moves back to
// 1/2 + z/2 >= z, and everything nearer than the far plane is in shadow, the blocker itself first. No test of w or of the
// range, no bias, and a filtered depth is compared where comparisons should be filtered.
float shadow_factor_lecture(sampler2D shadow_map, vec4 clip) {
    vec2 shadow_uv = clip.xy / clip.w;
    shadow_uv = shadow_uv * 0.5 + vec2(0.5);
    float real_depth = clip.z / clip.w;
    real_depth = real_depth * 0.5 + 0.5;
    const float shadow_depth = texture(shadow_map, shadow_uv).x;
    float factor = 1.0;
    if (shadow_depth < real_depth) {
        factor = 0.0;
    }
    return factor;
}

// The same without the second remap, which leaves the lack of a bias and of tests.
float shadow_factor_unbiased_lecture(sampler2D shadow_map, vec4 clip) {
    const vec2 shadow_uv = clip.xy / clip.w * 0.5 + vec2(0.5);
    return texture(shadow_map, shadow_uv).x < clip.z / clip.w ? 0.0 : 1.0;
}

// Slide "Steps of Cascade Shadow": every layer is sampled, then one result is kept; count look-ups for one.
float cascaded_shadow_lecture(sampler2DArrayShadow maps, mat4 clip_of_world[4], vec3 receiver, int count, int index) {
    float lit[4] = float[4](1.0, 1.0, 1.0, 1.0);
    for (int i = 0; i < count; ++i) {
        const vec4 clip = clip_of_world[i] * vec4(receiver, 1.0);
        lit[i] = texture(maps, vec4(clip.xy / clip.w * 0.5 + 0.5, float(i), clip.z / clip.w));
    }
    return lit[index];
}

// Slide "PCSS": infinite on the light, negative behind the receiver, not a number without a blocker (0 / 0 as the mean).
float pcss_penumbra_width_lecture(float receiver, float blocker, float size) {
    return (receiver - blocker) * size / blocker;
}
float pcss_mean_blocker_lecture(float sum, float count) {
    return sum / count;
}

// Slide "Variance Soft Shadow Map": moments of depth itself, E(x^2) - E(x)^2; in fp32 negative for flat depths near 1.
vec2 shadow_moments_lecture(float depth) {
    return vec2(depth, depth * depth);
}
float moments_variance_lecture(vec2 moments) {
    return moments.y - moments.x * moments.x;
}
// The inequality it names, with neither the one-tailed case (t below the mean) nor a least variance: 0 / 0 at t = mean.
float chebyshev_lecture(vec2 moments, float t) {
    const float variance = moments_variance_lecture(moments);
    return variance / (variance + (t - moments.x) * (t - moments.x));
}

#endif
