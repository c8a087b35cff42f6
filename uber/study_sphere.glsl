#ifndef KILN_STUDY_SPHERE_GLSL
#define KILN_STUDY_SPHERE_GLSL
// The unit sphere that the study shaders draw, seen along -z from afar: every normal that faces the viewer, each once.

// The normal at a place on the screen; a unit vector also where the sphere is not. uv: [0, 1]^2, v down.
vec3 sphere_normal(vec2 uv) {
    const vec2 p = (uv * 2.0 - 1.0) * vec2(1.05, -1.05);
    const float z2 = 1.0 - dot(p, p);
    return z2 > 0.0 ? vec3(p, sqrt(z2)) : vec3(p * inversesqrt(dot(p, p)), 0.0);
}

// Whether the sphere is there.
bool on_sphere(vec2 uv) {
    const vec2 p = (uv * 2.0 - 1.0) * vec2(1.05, -1.05);
    return dot(p, p) < 1.0;
}

const vec3 sphere_viewer = vec3(0.0, 0.0, 1.0);    // the direction to the viewer, everywhere

#endif
