#ifndef KILN_SHADOW_MAP_GLSL
#define KILN_SHADOW_MAP_GLSL
// Hard shadows from a depth map. Map and look-up use the same Vulkan matrix: z / w is depth in [0, 1] as it stands and
// uv = ndc.xy / 2 + 1/2 with no flip. Samplers compare with LESS_OR_EQUAL: 1 where the receiver is not behind what
// the map holds. Williams, "Casting Curved Shadows on Curved Surfaces", 1978; Reeves et al. 1987 for comparing before
// filtering.
#include "math.glsl"

// A receiver moved off its surface so far that the map's texels cannot shadow it. Inside one texel (bilinear comparison:
// one to each side, sqrt(2) texels on the diagonal) the plane's depth differs by sqrt(2) s tan(a), where a is the angle
// between the normal and the map's axis; moving by o along the normal clears o / cos(a); hence o = sqrt(2) s sin(a). The
// axis, not the light's direction: over a perspective map 1 / z of a plane rises by sin(a) as well, so that a plane that
// faces the light off the axis is not at one depth. 3 / 2 for sqrt(2): s grows by up to o / z on the way, and numbers round.
// position: world; n: unit; n_dot_axis: cosine of a, of either sign; texel: metres, side s of a texel here.
vec3 offset_shadow_receiver(vec3 position, vec3 n, float n_dot_axis, float texel) {
    return position + n * (1.5 * texel * sqrt(saturate(1.0 - n_dot_axis * n_dot_axis)));
}

// n_dot_axis for a perspective map: the axis is the row that makes w. clip_of_world: with the view distance in clip w; n: unit.
float perspective_axis_cosine(mat4 clip_of_world, vec3 n) {
    return dot(n, vec3(clip_of_world[0].w, clip_of_world[1].w, clip_of_world[2].w));
}

// n_dot_axis for a cube map: of the face that is looked at and, within four texels of its edges, of the neighbours that the
// moved receiver or its filter may reach, the one that moves furthest. from_light: receiver minus light; n: unit; texel: side
// of a texel 1 m away, metres: 2 over the texels a side.
float cube_axis_cosine(vec3 from_light, vec3 n, float texel) {
    const vec3 a = abs(from_light);
    const float z = max(max(a.x, a.y), a.z);
    const vec3 cosines = mix(vec3(1.0), abs(n), greaterThanEqual(a, vec3(z * (1.0 - 4.0 * texel))));
    return min(min(cosines.x, cosines.y), cosines.z);
}

// 1 lit, 0 in shadow. A receiver behind the light's plane (w <= 0) or outside the map (uv or depth not in [0, 1]) is lit:
// the map knows nothing of it. Reads the only level, so that it may stand in divergent code.
// clip: the receiver in the light's clip space; bias: depth units, >= 0, at least two quanta of the map.
float shadow_factor_2d(sampler2DShadow map, vec4 clip, float bias) {
    const bool in_front = clip.w > 0.0;
    const vec3 ndc = clip.xyz / (in_front ? clip.w : 1.0);
    const vec2 uv = ndc.xy * 0.5 + 0.5;
    const bool inside = in_front && all(greaterThanEqual(vec3(uv, ndc.z), vec3(0.0))) &&
                        all(lessThanEqual(vec3(uv, ndc.z), vec3(1.0)));
    const float lit = textureLod(map, vec3(uv, ndc.z - bias), 0.0);
    return inside ? lit : 1.0;
}

// The same from a point light's cube map, whose faces are six 90-degree perspectives from near to far: a face's view
// distance is the largest component of the direction, its depth far / (far - near) - far near / ((far - near) z).
// Call in uniform control flow: a cube comparison has no explicit level in all target languages.
// from_light: receiver minus light, world metres; near, far: metres, 0 < near < far; bias as above.
float shadow_factor_cube(samplerCubeShadow map, vec3 from_light, float near, float far, float bias) {
    const vec3 a = abs(from_light);
    const float z = max(max(a.x, a.y), a.z);
    const float scale = far / max(far - near, 1e-6);
    const float depth = scale - scale * near / max(z, 1e-6);
    const float lit = texture(map, vec4(from_light, depth - bias));
    return z >= near && z <= far ? lit : 1.0;
}

#endif
