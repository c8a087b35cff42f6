#ifndef KILN_GI_QUAD_GLSL
#define KILN_GI_QUAD_GLSL
// What scenes of gi_path.glsl are made of.

// origin + [0, 1] u + [0, 1] v with u across v. It faces along cross(u, v); its back is black. emission: radiance.
struct GiQuad {
    vec3 origin;
    vec3 u;
    vec3 v;
    vec3 albedo;
    vec3 emission;
};

// A point light that shines into the half space about `axis` alone; radiant intensity in W/sr.
struct GiLamp {
    vec3 position;
    vec3 axis;
    vec3 intensity;
};

#endif
