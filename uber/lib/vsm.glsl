#ifndef KILN_VSM_GLSL
#define KILN_VSM_GLSL
// Variance shadow maps: the share of a region that is lit, bounded from two moments of its depths, which unlike depth may be
// averaged. Donnelly and Lauritzen, "Variance Shadow Maps", 2006; with a penumbra: Yang, Dong, Feng, Seidel and Kautz,
// "Variance Soft Shadow Mapping", 2010.
//
// Moments are of q = distance / far - reference: linear distance from the light's plane (so that a blocker's mean is a
// distance), about a reference in the middle of the scene. E(q^2) - E(q)^2 loses as many digits as q has to spare over its
// spread: uncentred moments of depths near 1 give negative variances. Store them in 32-bit floats, never in 16: half a
// unit of fp16 at 1 is a variance of 5e-4. The bound is one-tailed and not tight: where two blockers stand above each other
// light bleeds.
#include "math.glsl"
#include "shadow_receiver.glsl"

// (q, q^2) of one texel. distance: metres from the light's plane; far: metres, > 0; reference: [0, 1], in units of far.
vec2 shadow_moments(float distance, float far, float reference) {
    const float q = distance / far - reference;
    return vec2(q, q * q);
}

// The same of a texel that a slanted plane crosses: a plane's depths within a pixel have variance (dx^2 + dy^2) / 12 for a
// gradient (dx, dy) of q a texel. (Lauritzen, GPU Gems 3 chapter 8, takes a quarter, for a Gaussian pixel of deviation 1/2.)
vec2 shadow_moments(float distance, float far, float reference, vec2 gradient) {
    return shadow_moments(distance, far, reference) + vec2(0.0, dot(gradient, gradient) / 12.0);
}

// E(q^2) - E(q)^2, not below least. least: > 0, in squared units of q: 1e-9 for centred moments in fp32; 2e-6 for plain ones.
float moments_variance(vec2 moments, float least) {
    return max(moments.y - moments.x * moments.x, least);
}

// Cantelli's bound on the share of depths that are at least t: s^2 / (s^2 + (t - m)^2) for t beyond the mean, else 1; within
// [0, 1], falling with t. Equality for two depths of which the further is t.
// t: the receiver's q.
float chebyshev_upper_bound(vec2 moments, float t, float least) {
    const float variance = moments_variance(moments, least);
    const float beyond = t - moments.x;
    return beyond <= 0.0 ? 1.0 : variance / (variance + beyond * beyond);
}

// Cuts off the dim end, where bleeding lives, and stretches the rest over [0, 1]. amount: [0, 1), 0.2 is common.
float reduce_light_bleeding(float lit, float amount) {
    return saturate((lit - amount) / (1.0 - amount));
}

// Mean q of the blockers if the receiver's plane is at t and a share p of the region is lit: (m - p t) / (1 - p), in the form
// m - (t - m) p / (1 - p), which keeps its digits as p nears 0. Where almost all is lit (p > 0.999) nothing can be told of
// the rest and the answer is t: no penumbra.
float vssm_blocker(vec2 moments, float t, float lit) {
    const float blocked = max(1.0 - lit, 0.001);
    return lit > 0.999 ? t : moments.x - (t - moments.x) * lit / blocked;
}

// Sum of all texels left of and above corner (exclusive) in a summed-area table of inclusive sums. Crow, "Summed-Area Tables
// for Texture Mapping", 1984. corner: [0, size].
vec2 sat_corner(sampler2D sat, ivec2 corner) {
    const vec2 sum = texelFetch(sat, max(corner - 1, ivec2(0)), 0).xy;
    return corner.x > 0 && corner.y > 0 ? sum : vec2(0.0);
}

// The same at any place, in texels: between corners the integral of a piecewise constant image is bilinear. By hand, since a
// sampler's weights have 8 bits and the sums need all of theirs.
vec2 sat_sum(sampler2D sat, vec2 place) {
    const vec2 low = floor(place);
    const vec2 part = place - low;
    const ivec2 size = textureSize(sat, 0);
    const ivec2 a = ivec2(low);
    const ivec2 b = min(a + 1, size);
    return mix(mix(sat_corner(sat, a), sat_corner(sat, ivec2(b.x, a.y)), part.x),
               mix(sat_corner(sat, ivec2(a.x, b.y)), sat_corner(sat, b), part.x), part.y);
}

// Mean moments over a box of uv, moved into the map and not smaller than a texel, from a summed-area table (moments.comp).
// Each of the four sums is off by some 2^-24 N^2 |q|, which is shared by the box's texels: of a box `width` of the map wide the
// moments are off by up to 2^-22 |q| / width^2, by much less where q is about as often positive as negative. So put the
// reference near the mean, and the least variance above that error; for narrow boxes take mip_average.
vec2 sat_average(sampler2D sat, vec2 centre, vec2 width) {
    const vec2 size = vec2(textureSize(sat, 0));
    const vec2 half_width = max(0.5 * width * size, vec2(0.5));
    const vec2 middle = clamp(centre * size, half_width, max(size - half_width, half_width));
    const vec2 low = clamp(middle - half_width, vec2(0.0), size);
    const vec2 high = clamp(middle + half_width, vec2(0.0), size);
    const vec2 extent = max(high - low, vec2(1e-3));
    const vec2 sum = sat_sum(sat, high) - sat_sum(sat, vec2(low.x, high.y)) - sat_sum(sat, vec2(high.x, low.y)) +
                     sat_sum(sat, low);
    return sum / (extent.x * extent.y);
}

// Mean moments over about the same box from a mip chain: the level whose texel is as wide, between levels and texels linear.
// Cheaper than the table and smoother than a box. moments: trilinear; levels: of the chain, >= 1.
vec2 mip_average(sampler2D moments, vec2 centre, vec2 width, float levels) {
    const float texels = max(max(width.x, width.y) * float(textureSize(moments, 0).x), 1.0);
    return textureLod(moments, centre, min(log2(texels), levels - 1.0)).xy;
}

// Visible share of the light by hard comparison's successor: one filtered look-up.
// moments: mean moments where the receiver is; distance: of the receiver from the light's plane, metres.
float vsm_factor(vec2 moments, float distance, float far, float reference, float least, float bleeding) {
    return reduce_light_bleeding(chebyshev_upper_bound(moments, distance / far - reference, least), bleeding);
}

// Width in uv of the box that holds whatever may stand between a receiver and the light: size (dR - near) / dR on the near plane.
// receiver: metres, [near, far]; others as below.
float vssm_search(float receiver, float size, float near, float extent, float texel) {
    return max(size * (receiver - near) / (receiver * extent * near), texel);
}

// Width in uv of the penumbra by the mean blocker of the search box, within [texel, search]; 0 where all of the box is lit.
// around: the box's mean moments; t: the receiver's q.
float vssm_penumbra(vec2 around, float t, float receiver, float size, float near, float far, float extent, float texel,
                    float search, float reference, float least) {
    const float lit = chebyshev_upper_bound(around, t, least);
    const float blocker = max((vssm_blocker(around, t, lit) + reference) * far, near);
    const float width = clamp(size * (receiver - blocker) / (blocker * extent * receiver), texel, search);
    return lit > 0.999 ? 0.0 : width;
}

// Visible share of a square light of width `size` from a summed-area table of moments, as pcss_factor (pcss.glsl) takes it
// from taps: mean blocker of the search box, penumbra, mean moments of the penumbra. Parameters as there and above.
float vssm_factor(sampler2D sat, vec4 clip, float size, float near, float far, float extent, float texel, float reference,
                  float least, float bleeding) {
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
    const float receiver = clamp(clip.w, near, far);
    const float t = receiver / far - reference;
    const float search = vssm_search(receiver, size, near, extent, texel);
    const vec2 around = sat_average(sat, place.xy, vec2(search));
    const float width = vssm_penumbra(around, t, receiver, size, near, far, extent, texel, search, reference, least);
    if (width == 0.0) {
        return 1.0;
    }
    const vec2 mean = sat_average(sat, place.xy, vec2(width));
    return reduce_light_bleeding(chebyshev_upper_bound(mean, t, least), bleeding);
}

// The same from a mip chain: two look-ups for the table's eight, no sums that lose digits, and a filter that is no box: its
// shape changes with where the box lies among the level's texels. moments, levels: as mip_average takes them.
float vssm_factor_mips(sampler2D moments, float levels, vec4 clip, float size, float near, float far, float extent, float texel,
                       float reference, float least, float bleeding) {
    const vec4 place = shadow_coordinates(clip);
    if (place.w == 0.0) {
        return 1.0;
    }
    const float receiver = clamp(clip.w, near, far);
    const float t = receiver / far - reference;
    const float search = vssm_search(receiver, size, near, extent, texel);
    const vec2 around = mip_average(moments, place.xy, vec2(search), levels);
    const float width = vssm_penumbra(around, t, receiver, size, near, far, extent, texel, search, reference, least);
    if (width == 0.0) {
        return 1.0;
    }
    const vec2 mean = mip_average(moments, place.xy, vec2(width), levels);
    return reduce_light_bleeding(chebyshev_upper_bound(mean, t, least), bleeding);
}

#endif
