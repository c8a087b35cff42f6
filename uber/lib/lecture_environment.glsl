#ifndef KILN_LECTURE_ENVIRONMENT_GLSL
#define KILN_LECTURE_ENVIRONMENT_GLSL
// The environment-map listing of GAMES104 lecture 05 as printed. A point of comparison, never a default.

// reflect() of a vector that points to the viewer: the exact opposite of the mirror direction.
vec3 environment_reflection_lecture(vec3 n, vec3 v) {
    return reflect(v, n);
}

// The level comes from screen derivatives, whatever the roughness. In uniform control flow of a fragment shader only.
vec3 sample_environment_lecture(samplerCube map, vec3 r) {
    return texture(map, r).rgb;
}

#endif
