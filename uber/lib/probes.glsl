#ifndef KILN_PROBES_GLSL
#define KILN_PROBES_GLSL
// Light probes between which a point lies, and reflection probes whose box it is in.
#include "math.glsl"
#include "sh.glsl"

// Weights of the eight corners of a grid cell. `low` is the four with z = 0: (0,0), (1,0), (0,1), (1,1) in (x, y); `high`
// those with z = 1. They sum to 1. t: the place in the cell, limited to [0, 1]^3 here.
struct TrilinearWeights {
    vec4 low, high;
};

TrilinearWeights trilinear_weights(vec3 t) {
    const vec3 b = clamp(t, vec3(0.0), vec3(1.0));
    const vec3 a = 1.0 - b;
    const vec4 xy = vec4(a.x * a.y, b.x * a.y, a.x * b.y, b.x * b.y);
    return TrilinearWeights(xy * a.z, xy * b.z);
}

// The cell of a grid of `count` probes an axis that holds a point, and the place in it. Points outside belong to the nearest
// cell, at its border. An axis of one probe has t = 0 and the cell's upper corner does not exist: weight 0.
// from_first: position minus the first probe; inverse_spacing: 1 / metres; count: >= 1.
struct GridCell {
    ivec3 cell;
    vec3 t;
};

GridCell probe_grid_cell(vec3 from_first, vec3 inverse_spacing, ivec3 count) {
    const vec3 last = vec3(max(count - 1, ivec3(0)));
    const vec3 g = clamp(from_first * inverse_spacing, vec3(0.0), last);
    const vec3 cell = min(floor(g), max(last - 1.0, vec3(0.0)));
    return GridCell(ivec3(cell), g - cell);
}

// How much a probe may say about a surface: one behind it sees the other side of a wall. ((cos + 1) / 2)^2 + 0.2, never 0, so
// that some probe is left. Majercik et al., "Dynamic Diffuse Global Illumination with Ray-Traced Irradiance Fields", JCGT
// 8(2), 2019. to_probe, n: unit vectors. Weights times this need normalize_weights.
float probe_facing_weight(vec3 to_probe, vec3 n) {
    const float wrapped = 0.5 * dot(to_probe, n) + 0.5;
    return wrapped * wrapped + 0.2;
}

// Weights limited to non-negative ones and scaled to a sum of 1; all equal when none is above 0. Components: finite, below 1e30.
vec4 normalize_weights(vec4 weights) {
    const vec4 w = max(weights, vec4(0.0));
    const float largest = max(max(w.x, w.y), max(w.z, w.w));
    const vec4 scaled = w / max(largest, 1e-30);
    const float sum = scaled.x + scaled.y + scaled.z + scaled.w;
    return largest > 1e-30 ? scaled / sum : vec4(0.25);
}

// Barycentric coordinates of p in the tetrahedron a, b, c, d: each the share of the volume that p makes with the opposite
// face. They sum to 1; p outside makes some negative (normalize_weights moves it towards the tetrahedron). A tetrahedron
// flatter than 1e-5 of its longest edges has no volume to divide by: weights by the inverse square of the distance then.
// Cupisz, "Light Probe Interpolation Using Tetrahedral Tessellations", GDC 2012. Edges between 1e-3 and 1e5 m.
vec4 tetrahedron_weights(vec3 p, vec3 a, vec3 b, vec3 c, vec3 d) {
    const vec3 ab = b - a, ac = c - a, ad = d - a, ap = p - a;
    const vec3 n_b = cross(ac, ad), n_c = cross(ad, ab), n_d = cross(ab, ac);
    const float volume = dot(ab, n_b);
    const float size = sqrt(max(dot(ab, ab), max(dot(ac, ac), dot(ad, ad))));
    const bool flat_one = !(abs(volume) > 1e-5 * size * size * size);
    const vec3 inside = vec3(dot(ap, n_b), dot(ap, n_c), dot(ap, n_d)) / (flat_one ? 1.0 : volume);
    const vec3 pb = p - b, pc = p - c, pd = p - d;
    const vec4 squares = vec4(dot(ap, ap), dot(pb, pb), dot(pc, pc), dot(pd, pd));
    const vec4 near = normalize_weights(1.0 / (squares + vec4(1e-6 * size * size + 1e-20)));
    return flat_one ? near : vec4(1.0 - inside.x - inside.y - inside.z, inside);
}

// sum + weight sh: blends of any number of probes. What is linear in light blends in any of the SH conventions, but not the
// ratios m1 / m0 of a lightmap.
ShL1 sh_add(ShL1 sum, ShL1 sh, float weight) {
    for (int i = 0; i < 4; ++i) sum.c[i] += weight * sh.c[i];
    return sum;
}

ShL2 sh_add(ShL2 sum, ShL2 sh, float weight) {
    for (int i = 0; i < 9; ++i) sum.c[i] += weight * sh.c[i];
    return sum;
}

ShMomentsL1 sh_add(ShMomentsL1 sum, ShMomentsL1 sh, float weight) {
    return ShMomentsL1(sum.m0 + weight * sh.m0, sum.m1_y + weight * sh.m1_y, sum.m1_z + weight * sh.m1_z,
                       sum.m1_x + weight * sh.m1_x);
}

// The direction from a reflection probe to where a ray from `position` meets the probe's box: what a cube map taken at
// `probe` shows there. Not of unit length. Lagarde and Zanuttini, "Local Image-based Lighting With Parallax-corrected
// Cubemap", SIGGRAPH 2012. A ray parallel to a wall never meets it: its component is held at 1e-20 in size, which makes that
// wall the farthest and never 0 times infinity. A point outside counts as on the wall that it left.
// position, box_min, box_max, probe: world, metres, below 1e6 in size; direction: not 0.
vec3 box_projected_direction(vec3 position, vec3 direction, vec3 box_min, vec3 box_max, vec3 probe) {
    const vec3 to_wall = vec3(direction.x < 0.0 ? position.x - box_min.x : box_max.x - position.x,
                              direction.y < 0.0 ? position.y - box_min.y : box_max.y - position.y,
                              direction.z < 0.0 ? position.z - box_min.z : box_max.z - position.z);
    const vec3 t = max(to_wall, vec3(0.0)) / max(abs(direction), vec3(1e-20));
    return position + direction * min(min(t.x, t.y), t.z) - probe;
}

// 1 deep inside a probe's box, 0 on its walls and outside, linear over `fade` metres. fade: >= 0; 0 gives a step.
float probe_box_weight(vec3 position, vec3 box_min, vec3 box_max, float fade) {
    const vec3 inside = min(position - box_min, box_max - position);
    return saturate(min(min(inside.x, inside.y), inside.z) / max(fade, 1e-6));
}

// A probe's reflection made as bright as the light at the shaded point: times the ratio of luminances of irradiance there
// and at the probe, at most `limit`. Lazarov, "Getting More Physical in Call of Duty: Black Ops II", SIGGRAPH 2013.
// All: >= 0. A probe in the dark (irradiance 0) has nothing to compare: ratio 1.
vec3 probe_normalized_reflection(vec3 reflection, vec3 irradiance_here, vec3 irradiance_at_probe, float limit) {
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    const float here = max(dot(irradiance_here, luminance), 0.0);
    const float there = max(dot(irradiance_at_probe, luminance), 0.0);
    const float ratio = there > 1e-20 ? min(here / max(there, 1e-20), limit) : 1.0;
    return reflection * ratio;
}

#endif
