#ifndef KILN_GI_AMBIENT_GLSL
#define KILN_GI_AMBIENT_GLSL
// Indirect light as a constant, and what light between like walls adds up to.
#include "math.glsl"

// Radiance a diffuse surface returns from an irradiance that is the same everywhere: albedo E / pi.
// albedo: [0, 1]; irradiance: W/m^2, [0, inf); open: the share of directions that are not blocked, [0, 1].
vec3 ambient_radiance(vec3 albedo, vec3 irradiance, float open) {
    return albedo * irradiance * (open / pi);
}

// Radiance within a closed room of emission e and albedo a after n bounces: e (1 + a + ... + a^n). By doubling:
// S(2m) = S(m) (1 + a^m), so that nothing cancels as a tends to 1, where e (1 - a^(n+1)) / (1 - a) does.
// albedo: [0, 1]; emission: [0, inf); bounces: [0, 65535].
vec3 interreflection(vec3 emission, vec3 albedo, int bounces) {
    vec3 sum = vec3(0.0);
    vec3 power = vec3(1.0);
    // From the highest bit of the number of terms down: sum of m terms and a^m.
    for (int bit = 16; bit >= 0; --bit) {
        sum += sum * power;
        power *= power;
        if (((bounces + 1) >> bit & 1) != 0) {
            sum = sum * albedo + 1.0;
            power *= albedo;
        }
    }
    return emission * sum;
}

// The same for ever: e / (1 - a). albedo: [0, 1), from 1 - 1e-6 on taken as that.
vec3 interreflection_limit(vec3 emission, vec3 albedo) {
    return emission / max(1.0 - albedo, 1e-6);
}

// Ambient visibility with the light that a crevice's walls pass on, a fit (Jimenez et al., "Practical Realtime Strategies
// for Accurate Indirect Occlusion", 2016): max(v, ((v a - b) ... ) with a, b, c linear in albedo. visibility, albedo: [0, 1].
vec3 multibounce_visibility(float visibility, vec3 albedo) {
    const vec3 a = 2.0404 * albedo - 0.3324;
    const vec3 b = -4.7951 * albedo + 0.6417;
    const vec3 c = 2.7552 * albedo + 0.6903;
    return max(vec3(visibility), ((visibility * a + b) * visibility + c) * visibility);
}

#endif
