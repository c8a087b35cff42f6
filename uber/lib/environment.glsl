#ifndef KILN_ENVIRONMENT_GLSL
#define KILN_ENVIRONMENT_GLSL
// Environment maps: which way to look, how blurred, and how directions map to cube faces and to an equirectangular picture.
#include "math.glsl"

// The direction that a mirror with normal n sends towards the viewer: reflect(-v, n). reflect() wants the *incident* vector,
// so that reflect(v, n) with v towards the viewer is the exact opposite. n, v: unit vectors, v towards the viewer.
vec3 environment_reflection(vec3 n, vec3 v) {
    return 2.0 * dot(n, v) * n - v;
}

// The mip of a chain whose level i was prefiltered for roughness i / (levels - 1) (Karis, "Real Shading in Unreal Engine 4",
// 2013). roughness: perceptual, limited to [0, 1] here; levels: >= 1.
float environment_lod(float roughness, float levels) {
    return saturate(roughness) * max(levels - 1.0, 0.0);
}

// Radiance of a prefiltered map around r. The level is explicit: derivatives know nothing of roughness, and jump where r
// does. A direction of length 0 has no face: it looks up. r: need not be of unit length.
vec3 sample_environment(samplerCube map, vec3 r, float roughness, float levels) {
    const vec3 a = abs(r);
    const bool is_direction = max(max(a.x, a.y), a.z) > 1e-30;
    return textureLod(map, is_direction ? r : vec3(0.0, 1.0, 0.0), environment_lod(roughness, levels)).rgb;
}

// Cube faces, numbered +x -x +y -y +z -z as layers are. Vulkan 1.3, section 16.5.3: the longest component wins, z before y
// before x when they tie. d: not 0.
int cube_face(vec3 d) {
    const vec3 a = abs(d);
    const int x_face = d.x < 0.0 ? 1 : 0;
    const int y_face = d.y < 0.0 ? 3 : 2;
    const int z_face = d.z < 0.0 ? 5 : 4;
    return a.z >= a.x && a.z >= a.y ? z_face : a.y >= a.x ? y_face : x_face;
}

// Where d pierces `face`, in [-1, 1]^2, u to the right and v down as texels lie. d: on that face, its largest
// component at least 1e-30.
vec2 cube_face_coordinates(vec3 d, int face) {
    const vec2 x_side = vec2(face == 0 ? -d.z : d.z, -d.y);
    const vec2 y_side = vec2(d.x, face == 2 ? d.z : -d.z);
    const vec2 z_side = vec2(face == 4 ? d.x : -d.x, -d.y);
    const float major = face < 2 ? d.x : face < 4 ? d.y : d.z;
    return (face < 2 ? x_side : face < 4 ? y_side : z_side) / max(abs(major), 1e-30);
}

// The way back: from the centre through a point of a face, not of unit length. face: [0, 5]; p: [-1, 1]^2.
vec3 cube_direction(int face, vec2 p) {
    const float side = (face & 1) == 0 ? 1.0 : -1.0;
    const vec3 x_side = vec3(side, -p.y, -side * p.x);
    const vec3 y_side = vec3(p.x, side, side * p.y);
    const vec3 z_side = vec3(side * p.x, -p.y, side);
    return face < 2 ? x_side : face < 4 ? y_side : z_side;
}

// Centre of a texel of a face in [-1, 1]^2. texel: [0, size); size: texels a side.
vec2 cube_texel_centre(ivec2 texel, int size) {
    return (2.0 * vec2(texel) + 1.0) / float(size) - 1.0;
}

// Solid angle of the texel around p of a face with `size` texels a side, by the midpoint: area (2 / size)^2 over the cube of
// the distance. Its relative error is below 1 / size^2, and the 6 size^2 texels sum to 4 pi within 0.4 / size^2 of it.
float cube_texel_solid_angle(vec2 p, float size) {
    const float d2 = 1.0 + dot(p, p);
    return 4.0 / (size * size * d2 * sqrt(d2));
}

// Equirectangular pictures: y is up, the middle column looks along +x, u grows from +x to +z. v is 0 at the top.
// At the poles, where atan(0, 0) is undefined, u is 0.5. The elevation comes from an atan of two sides: acos loses half its
// digits near the poles. d: not 0, need not be of unit length.
vec2 equirect_uv(vec3 d) {
    const float largest = max(max(abs(d.x), abs(d.y)), max(abs(d.z), 1e-30));
    const vec3 s = d / largest;
    const float horizontal = sqrt(s.x * s.x + s.z * s.z);
    const bool pole = horizontal < 1e-7;
    const float azimuth = atan(pole ? 0.0 : s.z, pole ? 1.0 : s.x);
    const float elevation = atan(horizontal, pole && s.y == 0.0 ? 1.0 : s.y);
    return vec2(azimuth / (2.0 * pi) + 0.5, elevation / pi);
}

// The way back, of unit length. uv: any; u repeats.
vec3 equirect_direction(vec2 uv) {
    const float azimuth = (uv.x - 0.5) * (2.0 * pi);
    const float polar = uv.y * pi;
    const float horizontal = sin(polar);
    return vec3(horizontal * cos(azimuth), cos(polar), horizontal * sin(azimuth));
}

// Reads such a picture at an explicit level: across the seam u jumps from 1 to 0, which derivatives would take for a whole
// picture and answer with the smallest mip. The sampler repeats in u. v stays half a row of the coarser level that is read
// away from its ends, so that a pole is never mixed with the opposite one, whatever the sampler does in v. d: not 0. lod: levels that
// the picture has; past them the size of a level that is asked for is undefined, so rows are counted from the first.
vec3 sample_equirect(sampler2D picture, vec3 d, float lod) {
    const vec2 uv = equirect_uv(d);
    const int rows = textureSize(picture, 0).y >> int(ceil(clamp(lod, 0.0, 30.0)));
    const float half_row = 0.5 / float(max(rows, 1));
    return textureLod(picture, vec2(uv.x, clamp(uv.y, half_row, 1.0 - half_row)), lod).rgb;
}

// A sky whose sun is an analytic light is kept without it. Radiance above `limit` is what the map cannot hold or what would
// spread over all its mips: the map keeps min(radiance, limit), and what was cut, times its solid angle, is the light's
// irradiance at normal incidence. radiance: >= 0; limit: at most 65504 for fp16 and BC6H.
vec3 environment_clamped(vec3 radiance, float limit) {
    return min(radiance, vec3(limit));
}

vec3 environment_excess(vec3 radiance, float limit) {
    return max(radiance - vec3(limit), vec3(0.0));
}

#endif
