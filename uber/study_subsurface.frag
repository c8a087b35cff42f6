#version 450
// Light that leaves a surface elsewhere than it entered, by the forms of lib/ for closed surfaces: on a lit sphere (wrap, preintegrated), as a blur of
// irradiance over a surface (gather, separable), and as the profile itself about a point (profile). manifests/library.yaml names the
// values.

#define SUBSURFACE_WRAP 0
#define SUBSURFACE_PREINTEGRATED_TABLE 1
#define SUBSURFACE_PREINTEGRATED_SPHERE 2
#define SUBSURFACE_PREINTEGRATED_RING 3
#define SUBSURFACE_GATHER_BURLEY 4
#define SUBSURFACE_SEPARABLE_BURLEY 5
#define SUBSURFACE_SEPARABLE_SKIN 6
#define SUBSURFACE_PROFILE_DIFFUSE 7
#define SUBSURFACE_PROFILE_SEARCHLIGHT 8
#define SUBSURFACE_PROFILE_MEAN_FREE_PATH 9
#define SUBSURFACE_PROFILE_DIPOLE 10

#define BURLEY_TAPS 16
#define PREINTEGRATED_STEPS 8
#define SEPARABLE_TAPS 9
#include "lib/math.glsl"
#include "lib/subsurface.glsl"
#include "lib/vectors.glsl"
#include "study_sphere.glsl"
#if SUBSURFACE == SUBSURFACE_SEPARABLE_BURLEY || SUBSURFACE == SUBSURFACE_SEPARABLE_SKIN
#include "lib/subsurface_separable.glsl"
#elif SUBSURFACE >= SUBSURFACE_PREINTEGRATED_TABLE && SUBSURFACE <= SUBSURFACE_PREINTEGRATED_RING
#include "lib/subsurface_preintegrated.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Subsurface {
    vec3 lamp_bearing;         // sphere: to a distant lamp, need not be of unit length
    float wrap;                // [0, 1]
    vec3 surface_albedo;       // [0, 1]
    float curvature;           // sphere: 1 / length
    vec3 free_path;            // diffuse mean free path, length, > 0; profile_mean_free_path: mean free path
    float picture_width;       // of gather, separable and profile in length, > 0
    vec3 scattering;           // dipole: reduced, 1 / length, >= 0; separable_skin: falloff, (0, 1]
    float index;               // dipole: of refraction, limited to [1, 2]
    vec3 absorption;           // dipole: 1 / length, > 0; separable_skin: strength, [0, 1]
    float turn;                // gather: turn of the taps, radians
};
layout(set = 0, binding = 1) uniform sampler2D preintegrated_table;
layout(set = 0, binding = 2) uniform sampler2D irradiance_picture;

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // rgb: linear; a: 1

vec3 left() {
    const vec3 s = burley_shape_diffuse(surface_albedo) / free_path;
#if SUBSURFACE <= SUBSURFACE_PREINTEGRATED_RING
    const vec3 n = sphere_normal(screen_uv);
    const float n_dot_l = dot(n, safe_normalize(lamp_bearing, sphere_viewer));
#if SUBSURFACE == SUBSURFACE_PREINTEGRATED_TABLE
    const vec3 lit = preintegrated_lookup(preintegrated_table, n_dot_l, curvature, s);
#elif SUBSURFACE == SUBSURFACE_PREINTEGRATED_SPHERE
    const vec3 lit = vec3(preintegrated_sphere(n_dot_l, curvature / s.x), preintegrated_sphere(n_dot_l, curvature / s.y),
                          preintegrated_sphere(n_dot_l, curvature / s.z));
#elif SUBSURFACE == SUBSURFACE_PREINTEGRATED_RING
    const vec3 lit = vec3(preintegrated_ring(n_dot_l, curvature, burley_gaussian_variance(s.x)),
                          preintegrated_ring(n_dot_l, curvature, burley_gaussian_variance(s.y)),
                          preintegrated_ring(n_dot_l, curvature, burley_gaussian_variance(s.z)));
#else
    const vec3 lit = vec3(wrap_diffuse(n_dot_l, wrap));
#endif
    return on_sphere(screen_uv) ? surface_albedo * lit : vec3(0.0);
#elif SUBSURFACE == SUBSURFACE_GATHER_BURLEY
    return surface_albedo * burley_gather(irradiance_picture, screen_uv, vec2(1.0 / picture_width), s, min(min(s.x, s.y), s.z), turn);
#elif SUBSURFACE == SUBSURFACE_SEPARABLE_BURLEY || SUBSURFACE == SUBSURFACE_SEPARABLE_SKIN
    vec4 kernel[SEPARABLE_TAPS];
#if SUBSURFACE == SUBSURFACE_SEPARABLE_BURLEY
    separable_kernel_burley(s, 9.0 / min(min(s.x, s.y), s.z), kernel);
#else
    separable_kernel_skin(scattering, absorption, kernel);
#endif
    return surface_albedo * separable_gather(irradiance_picture, screen_uv, vec2(1.0 / picture_width, 0.0), kernel);
#else
    const vec2 from_centre = (screen_uv - 0.5) * picture_width;
    const float r = sqrt(dot(from_centre, from_centre));
#if SUBSURFACE == SUBSURFACE_PROFILE_SEARCHLIGHT
    return surface_albedo * burley_profile(r, burley_shape_searchlight(surface_albedo) / free_path);
#elif SUBSURFACE == SUBSURFACE_PROFILE_MEAN_FREE_PATH
    return surface_albedo * burley_profile(r, burley_shape_mean_free_path(surface_albedo) / free_path);
#elif SUBSURFACE == SUBSURFACE_PROFILE_DIPOLE
    return dipole_profile(r, scattering, absorption, dipole_boundary(clamp(index, 1.0, 2.0)));
#else
    return surface_albedo * burley_profile(r, s);
#endif
#endif
}

void main() {
    color = vec4(left(), 1.0);
}
