#ifndef KILN_PCSS_GLSL
#define KILN_PCSS_GLSL
// Percentage-closer soft shadows: an area light's penumbra from one depth map made at its centre, under the assumption that
// light, blocker and receiver are parallel planes. Fernando, "Percentage-Closer Soft Shadows", 2005. For a straight edge
// parallel to a side of a square light the filter is exact; what is left is the taps' quantisation, at most 1 / (2 n).
//
// All distances are linear, in metres from the light's plane: clip.w of a perspective matrix, light_distance of what a depth
// map holds. Depth itself will not do: (dR - dB) / dB is a ratio of lengths.
//
// Macros, before inclusion: PCSS_BLOCKER_TAPS, PCSS_FILTER_TAPS: 4 to 256; PCSS_DISK_LIGHT: 0 square, 1 round light.
#include "math.glsl"
#include "pcf.glsl"
#include "shadow_receiver.glsl"

#ifndef PCSS_BLOCKER_TAPS
#define PCSS_BLOCKER_TAPS 32
#endif
#ifndef PCSS_FILTER_TAPS
#define PCSS_FILTER_TAPS 32
#endif
#ifndef PCSS_DISK_LIGHT
#define PCSS_DISK_LIGHT 0
#endif

// Distance from the light's plane, metres, of a perspective map's depth in [0, 1]: n f / (n d + f (1 - d)), which loses
// nothing as d nears 1. near, far: metres, 0 < near < far.
float light_distance(float depth, float near, float far) {
    return near * far / (near * depth + far * (1.0 - depth));
}

// Distance of what any map holds; near = 0 says an orthographic one, whose depth runs over far metres.
float map_distance(float depth, float near, float far) {
    return near > 0.0 ? light_distance(depth, near, far) : far * depth;
}

// Width on the near plane of all that can stand between the receiver and some point of the light: size (dR - near) / dR.
// receiver: metres from the light's plane; size: of the light, metres; near: metres, > 0, no blocker is nearer.
float pcss_search_width(float receiver, float near, float size) {
    return size * max(receiver - near, 0.0) / max(receiver, near);
}

// Width of the penumbra at the receiver, metres: size (dR - dB) / dB, within [least, most]. A blocker behind the receiver
// gives least, one on the light most.
// receiver, blocker: metres from the light's plane, >= 0; size: metres; 0 <= least <= most.
float pcss_penumbra_width(float receiver, float blocker, float size, float least, float most) {
    return clamp(size * (receiver - blocker) / max(blocker, 1e-6), least, most);
}

// The same under a directional light of angular diameter a, whose map is orthographic: 2 tan(a / 2) (dR - dB).
// angular_size: 2 tan(a / 2), 0.0093 for the sun.
float pcss_penumbra_width_directional(float receiver, float blocker, float angular_size, float least, float most) {
    return clamp(angular_size * (receiver - blocker), least, most);
}

// Steps of lattices of 1 to 256 points, four a word from the low byte on: coprime to the count, so that the rows are as many as
// the columns, and of those the least whose shortest vector is longest.
const uint pcss_steps[64] = uint[64](
    0x01010101u, 0x03020102u, 0x05030302u, 0x03040305u, 0x03040504u, 0x05050508u, 0x05050507u, 0x070c070cu,
    0x05060d07u, 0x07070706u, 0x070c0509u, 0x07070713u, 0x07070709u, 0x09100708u, 0x07091110u, 0x13081708u,
    0x09081908u, 0x0b150908u, 0x09081f10u, 0x09091122u, 0x190b091fu, 0x090a090du, 0x091b0b22u, 0x0b0b0b0au,
    0x090a0d0au, 0x0b0c0b1eu, 0x0b0b0b0bu, 0x29140d1eu, 0x0b0c0b1fu, 0x0b0b0b35u, 0x0d0b3310u, 0x170c0b0cu,
    0x0d1e2f23u, 0x0d1f1d33u, 0x0d0c0d0du, 0x1f0c3b2bu, 0x0d353d0cu, 0x0d0d0d0du, 0x1d182f23u, 0x313d0f24u,
    0x0d320d25u, 0x0d240d4cu, 0x250d2710u, 0x3f2f0d0fu, 0x0d29370eu, 0x39221327u, 0x0f431d10u, 0x290e2919u,
    0x110e550eu, 0x13253523u, 0x490f0f10u, 0x253d0f20u, 0x111c1138u, 0x1d101111u, 0x291d0f10u, 0x0f0f6167u,
    0x3d1e6322u, 0x11101111u, 0x25101f10u, 0x131c1310u, 0x392b1547u, 0x11111110u, 0x2f4a1111u, 0x47102d10u
);

// Tap i of count over a square of width 1 about the centre: a rank-1 lattice. In projection on either axis count levels lie
// 1 / count apart, shifted around the torus by jitter. count: [4, 256]; jitter: [0, 1)^2, 0 for none, else a hash of the pixel.
vec2 pcss_square_tap(int i, int count, vec2 jitter) {
    const int step = int((pcss_steps[(count - 1) / 4] >> (8 * ((count - 1) % 4))) & 255u);
    const vec2 cell = (vec2(i, (i * step) % count) + 0.5) / float(count);
    return fract(cell + jitter) - 0.5;
}

// The same over a disk of diameter 1: Vogel's spiral, "A better way to construct the sunflower head", 1979. turn: [0, 1).
vec2 pcss_disk_tap(int i, int count, float turn) {
    const float radius = 0.5 * sqrt((float(i) + 0.5) / float(count));
    return radius * cos_sin_of_turn(fract(float(i) * 0.38196601 + turn));
}

// Over the light's shape.
vec2 pcss_tap(int i, int count, vec2 jitter) {
#if PCSS_DISK_LIGHT
    return pcss_disk_tap(i, count, jitter.x);
#else
    return pcss_square_tap(i, count, jitter);
#endif
}

// x: mean distance from the light's plane of what stands before the receiver within the search box, metres; y: the share of
// taps that met a blocker, 0 to 1. Without one x is 0.
// map: the depth map, nearest filtering; width: of the box, uv; near, far: as map_distance takes them; others as in pcf.glsl.
vec2 pcss_blockers(sampler2D map, vec3 place, vec2 slope, float bias, vec2 width, float near, float far, vec2 jitter) {
    float sum = 0.0;
    float blockers = 0.0;
    for (int i = 0; i < PCSS_BLOCKER_TAPS; ++i) {
        const vec2 offset = pcss_tap(i, PCSS_BLOCKER_TAPS, jitter) * width;
        const vec3 at = vec3(place.xy + offset, place.z + dot(slope, offset) - bias);
        const float depth = clamp(textureLod(map, at.xy, 0.0).r, 0.0, 1.0);
        const bool inside = all(greaterThanEqual(at.xy, vec2(0.0))) && all(lessThanEqual(at, vec3(1.0)));
        if (inside && depth < at.z) {
            sum += map_distance(depth, near, far);
            blockers += 1.0;
        }
    }
    return vec2(blockers > 0.0 ? sum / blockers : 0.0, blockers / float(PCSS_BLOCKER_TAPS));
}

// The mean of comparisons over the light's shape scaled to a width.
float pcss_filter(sampler2DShadow map, vec3 place, vec2 slope, float bias, vec2 width, vec2 jitter) {
    float lit = 0.0;
    for (int i = 0; i < PCSS_FILTER_TAPS; ++i) {
        lit += shadow_tap(map, place, slope, bias, pcss_tap(i, PCSS_FILTER_TAPS, jitter) * width);
    }
    return lit / float(PCSS_FILTER_TAPS);
}

// Visible share of a light of width `size`, 0 to 1, from a perspective map made at its centre whose matrix has the view
// distance in clip.w. The penumbra is never narrower than a texel nor wider than the search, which contains every penumbra
// of blockers beyond near.
// depth_map, shadow_map: one map, read as it is and by comparison. clip: the receiver in the light's clip space.
// size: metres, >= 0. near, far: of the matrix, metres. extent: width of the map in metres at 1 m, 2 tan(half the field of
// view). texel: side of a texel, uv.
float pcss_factor(sampler2D depth_map, sampler2DShadow shadow_map, vec4 clip, vec2 slope, float bias, float size, float near,
                  float far, float extent, float texel, vec2 jitter) {
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
    const float receiver = clamp(clip.w, near, far);
    const float search = max(pcss_search_width(receiver, near, size) / (extent * near), texel);
    const vec2 blockers = pcss_blockers(depth_map, place.xyz, slope, bias, vec2(search), near, far, jitter);
    if (blockers.y == 0.0) {
        return 1.0;
    }
    const float uv_of_metre = 1.0 / (extent * receiver);
    const float width = pcss_penumbra_width(receiver, blockers.x, size, texel / uv_of_metre, search / uv_of_metre);
    return pcss_filter(shadow_map, place.xyz, slope, bias, vec2(width * uv_of_metre), jitter);
}

// The same under a directional light from an orthographic map, whose depth runs over `range` metres and which is `extent`
// metres wide. angular_size: 2 tan(half the light's angular diameter).
float pcss_factor_directional(sampler2D depth_map, sampler2DShadow shadow_map, vec4 clip, vec2 slope, float bias,
                              float angular_size, float range, float extent, float texel, vec2 jitter) {
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
    const float search = max(angular_size * place.z * range / extent, texel);
    const vec2 blockers = pcss_blockers(depth_map, place.xyz, slope, bias, vec2(search), 0.0, range, jitter);
    if (blockers.y == 0.0) {
        return 1.0;
    }
    const float width =
        pcss_penumbra_width_directional(place.z * range, blockers.x, angular_size, texel * extent, search * extent);
    return pcss_filter(shadow_map, place.xyz, slope, bias, vec2(width / extent), jitter);
}

#endif
