#ifndef KILN_STUDY_DIRECTIONS_GLSL
#define KILN_STUDY_DIRECTIONS_GLSL
// A square as the directions of a sphere by stereographic projection: +z in the middle, the circle half-way to the sides is across it, the
// corners are 39 degrees from -z. uv: [0, 1]^2, v down. Without a root or a sine, so nearly exact.
vec3 square_direction(vec2 uv) {
    const vec2 p = (uv * 2.0 - 1.0) * vec2(2.0, -2.0);
    const float p2 = dot(p, p);
    return vec3(2.0 * p, 1.0 - p2) / (1.0 + p2);
}

#endif
