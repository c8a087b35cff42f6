#ifndef KILN_MERL_GLSL
#define KILN_MERL_GLSL
// Where a pair of directions lies in a table of the MERL BRDF database (Matusik et al., "A Data-Driven Reflectance Model",
// 2003): 90 x 90 x 180 bins over the half angle theta_h (by its square root), the difference angle theta_d (linear) and the
// difference azimuth phi_d (linear, [0, pi) by reciprocity). One plane of bins a colour: red, green, blue.
// A texture of the table goes to merl_lookup and its cheaper forms; who keeps the stored numbers themselves, in a buffer say,
// fetches by merl_index and gives them to merl_reflectance.
#include "math.glsl"

const int merl_theta_h_bins = 90;
const int merl_theta_d_bins = 90;
const int merl_phi_d_bins = 180;
const int merl_plane = 90 * 90 * 180;    // bins a colour: green is this far behind red

// atan(y, x), and 0 where both are 0, which GLSL leaves open.
float angle_of(float y, float x) {
    return y == 0.0 && x == 0.0 ? 0.0 : atan(y, x);
}

// The coordinates (theta_h, theta_d, phi_d) in bins: [0, 90], [0, 90], [0, 180). A bin is the integer part.
//   theta_h = 90 sqrt(angle(n, h) / (pi/2)), so that the first bins end at 0.011, 0.044, 0.1 degrees
// Rotating n to the pole of h, phi_d is the azimuth of l from the plane of n and h: atan(l . (n x h), (l.h)(n.h) - n.l).
// Angles from sine and cosine, never from acos, which is 1.6e-4 off near 1. Where n = h, phi_d is 0.
// n, v, l: unit vectors, l and v above the surface; h: unit half vector of v and l.
vec3 merl_coordinates(vec3 n, vec3 l, vec3 h) {
    const vec3 across = cross(n, h);
    const vec3 aside = cross(l, h);
    const float n_dot_h = dot(n, h);
    const float l_dot_h = dot(l, h);
    const float theta_h = angle_of(sqrt(dot(across, across)), n_dot_h);
    const float theta_d = angle_of(sqrt(dot(aside, aside)), l_dot_h);
    float phi_d = angle_of(dot(l, across), l_dot_h * n_dot_h - dot(n, l));
    phi_d = phi_d < 0.0 ? phi_d + pi : phi_d;
    phi_d = phi_d >= pi ? 0.0 : phi_d;
    return vec3(90.0 * sqrt(clamp(theta_h / (0.5 * pi), 0.0, 1.0)), 90.0 * clamp(theta_d / (0.5 * pi), 0.0, 1.0),
                180.0 * phi_d / pi);
}

// Index of a bin in one plane. bin: (theta_h, theta_d, phi_d), in range.
int merl_index(ivec3 bin) {
    return bin.z + merl_phi_d_bins * (bin.y + merl_theta_d_bins * bin.x);
}

// The bin that holds these coordinates, as the database's own reader looks up. coordinates: of merl_coordinates.
ivec3 merl_bin(vec3 coordinates) {
    return clamp(ivec3(coordinates), ivec3(0), ivec3(89, 89, 179));
}

// Eight bins and the weights between them: linear between the bins' centres, held at the ends of theta_h and theta_d, round
// the circle in phi_d. Each corner takes every coordinate from low or high, and its weight is the product of 1 - weight or
// weight of these coordinates.
struct MerlCorners {
    ivec3 low, high;
    vec3 weight;    // of high; 1 - weight of low
};

MerlCorners merl_corners(vec3 coordinates) {
    const vec3 c = coordinates - 0.5;
    const vec3 whole = floor(c);
    const ivec3 low = ivec3(whole);
    MerlCorners m;
    m.low = ivec3(clamp(low.xy, ivec2(0), ivec2(89)), low.z < 0 ? 179 : min(low.z, 179));
    m.high = ivec3(clamp(low.xy + 1, ivec2(0), ivec2(89)), low.z >= 179 ? 0 : low.z + 1);
    m.weight = c - whole;
    return m;
}

// Three stored numbers as a BRDF, per steradian: scales 1, 1.15, 1.66 over 1500. Bins that were not measured hold -1, and
// give 0. stored: red, green, blue at one bin.
vec3 merl_reflectance(vec3 stored) {
    return max(stored, vec3(0.0)) * (vec3(1.0, 1.15, 1.66) / 1500.0);
}

// The table as a 3D texture, of rgba32f or, where no value is above 65504, rgba16f (reference/merl_file.h makes it): columns
// are phi_d, 182 of them, bins 179, 0, ... 179, 0, so that a filter goes on round the circle; rows theta_d, slices theta_h.
// rgb: BRDF per steradian; a: 1, or 0 as all of the texel where nothing was measured. A look-up between bins is the sum of
// rgb over the sum of a, so that bins without a value do not darken what lies beside them.
vec4 merl_texel(sampler3D table, ivec3 bin) {
    return texelFetch(table, ivec3(bin.z + 1, bin.y, bin.x), 0);
}

// sum: of weighted texels. 0 where none of them was measured, and up to a weight of 1e-6 in sum.
vec3 merl_measured(vec4 sum) {
    return sum.rgb / max(sum.a, 1e-6);
}

// BRDF per steradian of the bin that holds the coordinates: one fetch, and steps from bin to bin.
vec3 merl_lookup_nearest(sampler3D table, vec3 coordinates) {
    return merl_measured(merl_texel(table, merl_bin(coordinates)));
}

// BRDF per steradian between eight bins, with weights in full precision.
vec3 merl_lookup(sampler3D table, vec3 coordinates) {
    const MerlCorners m = merl_corners(coordinates);
    vec4 plane[2];
    for (int i = 0; i < 2; ++i) {
        const int h = i == 0 ? m.low.x : m.high.x;
        const vec4 low = mix(merl_texel(table, ivec3(h, m.low.y, m.low.z)), merl_texel(table, ivec3(h, m.low.y, m.high.z)),
                             m.weight.z);
        const vec4 high = mix(merl_texel(table, ivec3(h, m.high.y, m.low.z)), merl_texel(table, ivec3(h, m.high.y, m.high.z)),
                              m.weight.z);
        plane[i] = mix(low, high, m.weight.y);
    }
    return merl_measured(mix(plane[0], plane[1], m.weight.x));
}

// The same by one look-up. table: linear filter, clamped to its edge. Vulkan asks for no more than 4 bits of weights, and
// devices have 8 (subTexelPrecisionBits): 1/256 of what neighbouring bins differ by.
vec3 merl_lookup_filtered(sampler3D table, vec3 coordinates) {
    return merl_measured(textureLod(table, (coordinates.zyx + vec3(1.0, 0.0, 0.0)) / vec3(182.0, 90.0, 90.0), 0.0));
}

#endif
