#ifndef KILN_NORMAL_MAP_GLSL
#define KILN_NORMAL_MAP_GLSL
// Normal maps and tangent frames. A frame's columns are tangent, bitangent, normal.
#include "math.glsl"
#include "vectors.glsl"

// Two unit vectors that make a right-handed frame with n. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT
// 6(1), 2017. n: unit vector.
mat3 frame_of_normal(vec3 n) {
    const float s = n.z < 0.0 ? -1.0 : 1.0;
    const float a = -1.0 / (s + n.z);
    const float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// The frame of an interpolated tangent: t made orthogonal to n (Gram and Schmidt), bitangent by handedness. Where t is 0,
// or within 1e-3 of n's axis (then what is left of it is mostly rounding), frame_of_normal in place.
// n: unit vector; t: any finite; handedness: its sign counts.
mat3 tangent_frame(vec3 n, vec3 t, float handedness) {
    const vec3 unit = safe_normalize(t, vec3(0.0));
    const vec3 flat_t = unit - n * dot(n, unit);
    const float size2 = dot(flat_t, flat_t);
    if (size2 < 1e-6) return frame_of_normal(n);
    // Once more: the first pass leaves 6e-8 of n, which is much where little of t was left.
    const vec3 again = flat_t * inversesqrt(size2);
    const vec3 tangent = normalize(again - n * dot(n, again));
    return mat3(tangent, cross(n, tangent) * (handedness < 0.0 ? -1.0 : 1.0), n);
}

// The frame from how position and uv change over the screen (Schueler, "Normal Mapping Without Precomputed Tangents",
// ShaderX5, 2006), for meshes without tangents. Where the uv map is singular (a point or a line), frame_of_normal.
// n: unit vector; dp_x, dp_y: derivatives of the position, duv_x, duv_y: of the uv, all finite.
mat3 cotangent_frame(vec3 n, vec3 dp_x, vec3 dp_y, vec2 duv_x, vec2 duv_y) {
    const vec3 u = safe_normalize(dp_x, vec3(0.0));
    const vec3 v = safe_normalize(dp_y, vec3(0.0));
    const float size_x = max_component(abs(dp_x));
    const float size_y = max_component(abs(dp_y));
    const float area = dot(cross(u, v), n);
    const vec2 across_x = duv_x / max(max(abs(duv_x.x), abs(duv_x.y)), 1e-30);
    const vec2 across_y = duv_y / max(max(abs(duv_y.x), abs(duv_y.y)), 1e-30);
    const float det = across_x.x * across_y.y - across_x.y * across_y.x;
    if (abs(det) < 1e-4 || abs(area) < 1e-4 || size_x < 1e-30 || size_y < 1e-30) return frame_of_normal(n);
    const float sign_area = area < 0.0 ? -1.0 : 1.0;
    const vec3 gradient_x = cross(dp_y / size_y, n) / size_x;    // up to one common positive factor the gradients of
    const vec3 gradient_y = cross(n, dp_x / size_x) / size_y;    // the screen's x and y on the surface
    const vec3 t = sign_area * (gradient_x * duv_x.x + gradient_y * duv_y.x);
    const vec3 b = sign_area * (gradient_x * duv_x.y + gradient_y * duv_y.y);
    return tangent_frame(n, t, dot(cross(n, t), b));
}

// An 8-bit texel as a tangent-space normal, with 128 as 0:  (255 t - 128) / 127, at least -1. The usual 2 t - 1 has no 0:
// 127 and 128 are -0.0039 and 0.0039, a tilt of 0.32 degrees on a flat surface. texel: [0, 1], UNORM.
vec3 decode_normal_unorm8(vec3 texel) {
    return max((255.0 * texel - 128.0) / 127.0, vec3(-1.0));
}

// 2 t - 1, for maps of more bits or that were encoded so. texel: [0, 1].
vec3 decode_normal(vec3 texel) { return 2.0 * texel - 1.0; }

// The third component of a two-channel (BC5) normal. xy: [-1, 1]; outside the circle z is 0.
vec3 decode_normal_xy(vec2 xy) { return vec3(xy, sqrt(max(1.0 - dot(xy, xy), 0.0))); }

// A tangent-space normal in the world, unit; the frame's own normal where it has no length.
// frame: orthonormal; normal: any finite.
vec3 apply_normal(mat3 frame, vec3 normal) { return safe_normalize(frame * normal, frame[2]); }

#endif
