// The light of a forward or deferred pass: one, from block Light.

#if LIGHT_TYPE == LIGHT_POINT || LIGHT_TYPE == LIGHT_SPOT
#include "lib/lights.glsl"
#endif

// Unit vector from a place towards the light.
vec3 direction_to_light(vec3 position) {
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    return safe_normalize(-light_direction, vec3(0.0, 1.0, 0.0));
#else
    return safe_normalize(light_position - position, vec3(0.0, 1.0, 0.0));
#endif
}

// Irradiance on a plane that faces the light, without shadows.
vec3 light_irradiance(vec3 position, vec3 l) {
#if LIGHT_TYPE == LIGHT_DIRECTIONAL
    return light_intensity;
#else
    const vec3 to_light = light_position - position;
    float attenuation = distance_attenuation(dot(to_light, to_light), light_range);
#if LIGHT_TYPE == LIGHT_SPOT
    attenuation *= cone_attenuation(dot(-l, light_direction), light_cos_inner, light_cos_outer);
#endif
    return light_intensity * attenuation;
#endif
}
