#ifndef KILN_ENERGY_GLSL
#define KILN_ENERGY_GLSL
// What a single-scattering microfacet lobe loses, put back. `dfg` is the split-sum pair (A, B) at (n.v, roughness), and
// E = A + B the lobe's directional albedo at F = 1.
#include "fresnel.glsl"

// The factor on a single-scattering specular lobe:  1 + F0 (1 / E - 1).  Makes a white metal reflect all that arrives
// (Lagarde and Golubev, in Filament's guide, section 4.7.2, after Turquin 2019). f0: [0, 1]; e: held at or above 1e-3 here.
vec3 multiscatter_scale(vec3 f0, float e) {
    return vec3(1.0) + f0 * (1.0 / clamp(e, 1e-3, 1.0) - 1.0);
}

// What the lobe itself reflects of uniform light: F0 A + F90 B. dfg: [0, 1], sum at most 1; f0: [0, 1].
vec3 single_scatter_albedo(vec3 f0, vec2 dfg) {
    return f0 * dfg.x + vec3(fresnel_f90(f0) * dfg.y);
}

// What further bounces between microfacets add, of uniform light:
//   (1 - E) Fss Favg / (1 - (1 - E) Favg),   Fss as above, Favg the mean Fresnel
// Fdez-Aguera, "A Multiple-Scattering Microfacet Model for Real-Time Image-Based Lighting", JCGT 8(1), 2019.
// dfg: [0, 1], sum at most 1; f0: [0, 1].
vec3 multiple_scatter_albedo(vec3 f0, vec2 dfg) {
    const float lost = 1.0 - saturate(dfg.x + dfg.y);
    const vec3 average = fresnel_average(f0);
    return lost * single_scatter_albedo(f0, dfg) * average / max(vec3(1.0) - lost * average, vec3(1e-3));
}

// What is left for the diffuse base below: 1 - single - multiple scattering, not negative. dfg: [0, 1]; f0: [0, 1].
vec3 diffuse_below(vec3 f0, vec2 dfg) {
    return max(vec3(1.0) - single_scatter_albedo(f0, dfg) - multiple_scatter_albedo(f0, dfg), vec3(0.0));
}

// A BRDF for the lost light, per steradian, symmetric in l and v:
//   (1 - E(l)) (1 - E(v)) / (pi (1 - Eavg)) Favg^2 Eavg / (1 - Favg (1 - Eavg))
// Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017. Eavg = 2 integral of E(m) m dm.
// e_l, e_v, e_avg: (0, 1]; f_avg: [0, 1]. 0 where nothing is lost.
vec3 multiscatter_lobe(float e_l, float e_v, float e_avg, vec3 f_avg) {
    const float lost = max(1.0 - e_avg, 1e-6);
    const vec3 coloured = f_avg * f_avg * e_avg / (vec3(1.0) - f_avg * (1.0 - e_avg));
    return coloured * ((1.0 - e_l) * (1.0 - e_v) / (pi * lost));
}

#endif
