#version 450
// One light, or all indirect light, added over the screen to what the g-buffer pass left: surface's forward pass taken apart.
// Blending is additive over gbuffer_radiance, which no pass reads. Materials differ by pixel, so both reflection models are here.

#include "surface_axes.glsl"
#include "surface_interface.glsl"
#include "lib/math.glsl"
#include "lib/vectors.glsl"
#include "deferred_interface.glsl"
#if LIGHT_TYPE != LIGHT_NONE
#include "lib/blinn_phong.glsl"
#include "lib/cook_torrance.glsl"
#include "surface_light.glsl"
#include "surface_shadow.glsl"
#elif IBL == IBL_SPLIT_SUM
#include "surface_environment.glsl"
#endif

layout(location = 0) out vec4 color;    // rgb: scene radiance to add

void main() {
    const Pixel p = read_pixel();
#if LIGHT_TYPE != LIGHT_NONE
    const vec3 v = safe_normalize(camera_position - p.position, p.n);
    const vec3 l = direction_to_light(p.position);
    const vec3 glossy = cook_torrance(p.n, v, l, p.diffuse, p.specular, p.roughness);
    const vec3 shiny = blinn_phong(p.n, v, l, p.diffuse, p.specular, blinn_phong_shininess(p.roughness));
    const vec3 reflected = p.ggx ? glossy : shiny;
    const vec3 added = reflected * light_irradiance(p.position, l) * light_visibility(p.position, p.geometric_n, l);
#elif IBL == IBL_SPLIT_SUM
    // Blinn-Phong has no specular part under an environment.
    const vec3 v = safe_normalize(camera_position - p.position, p.n);
    const vec3 irradiance = p.baked ? p.irradiance_over_pi * pi : sky_irradiance(p.n);
    const vec3 f0 = p.ggx ? p.specular : vec3(0.0);
    const vec3 added = environment_light(p.position, p.n, v, p.diffuse, f0, p.roughness, irradiance);
#else
    const vec3 added = p.diffuse * p.irradiance_over_pi;
#endif
    color = vec4(p.drawn ? added : vec3(0.0), 0.0);
}
