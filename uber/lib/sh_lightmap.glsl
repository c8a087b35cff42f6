#ifndef KILN_SH_LIGHTMAP_GLSL
#define KILN_SH_LIGHTMAP_GLSL
// A lightmap that keeps the first spherical-harmonics band, so that it lights from a direction.
// O'Donnell, "Precomputed Global Illumination in Frostbite", GDC 2018.

// One texel of the first band. Stored is 0.5 + 0.5 m1 / m0 a channel, since BC1 and BC7 hold [0, 1]; m1 / m0 of
// non-negative light never leaves [-1, 1]. texel: [0, 1]. Returns the ratio in [-1, 1].
vec3 decode_sh_ratio(vec3 texel) {
    return texel * 2.0 - 1.0;
}

// The way in, for a bake: what a BC1 or BC7 texel holds. Where no light arrives at all the ratio is 0.
// m0: >= 0; m1: one coefficient of the same texel, by channel.
vec3 encode_sh_ratio(vec3 m0, vec3 m1) {
    return clamp(0.5 + 0.5 * m1 / max(m0, vec3(1e-20)), vec3(0.0), vec3(1.0));
}

// Irradiance of a lightmap without directions, for the normal that it was baked with. An RGBA8 texture with sRGB transfer
// holds E / range: its sampler has made the texel linear already, and `range` is the largest irradiance in the map, W/m2.
// Half a step is 4.5e-3 of the value at the top, where the curve rises by 2.27, and all of it below range / 6600.
vec3 decode_flat_lightmap(vec3 texel, float range) {
    return texel * range;
}

// Irradiance on a receiver with normal n from *raw moments* of the incident radiance L:
//   m0 = integral of L,   m1 = integral of L times direction (each over the sphere),   E(n) = m0 / 4 + (m1 . n) / 2
// 0.25 and 0.5 are cosine-lobe weights times both basis constants (pi Y0^2, 2 pi/3 Y1^2), so a bake that multiplied by
// Y0 and Y1 must not be read with them: constant L = 1 has m0 = 4 pi, and E = pi. Opposite a small bright light the
// two-band sum is negative: limited to 0.
// m0: >= 0, W/m2; ratio_y, ratio_z, ratio_x: m1 / m0 by channel, one vector a coefficient; n: unit vector.
vec3 sh_l1_irradiance(vec3 m0, vec3 ratio_y, vec3 ratio_z, vec3 ratio_x, vec3 n) {
    return m0 * max(vec3(0.25) + 0.5 * (ratio_y * n.y + ratio_z * n.z + ratio_x * n.x), vec3(0.0));
}

#endif
