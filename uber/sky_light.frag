#version 450
// Sky light on a base-pass pixel: the smallest uber shader, 4 boolean axes, 16 variants, 5 different texts.
//
// After the listing in GAMES104 lecture 05 ("Uber Shader and Variants"), itself cut from a base-pass pixel shader. The
// listing asks `#ifndef ENABLE_SKY_LIGHT` of a macro that is always defined as 0 or 1 (every variant would be empty),
// closes one `#endif` too many, compares a float with `==`, and opens a brace in one `#if` and closes it in another.
// Here the macro is asked by value, the test is `<=`, and the condition is computed in one place.

layout(location = 0) in vec3 world_normal;            // need not be of unit length
layout(location = 1) in vec3 diffuse_color;           // linear reflectance, [0, 1]
layout(location = 2) in vec4 sky_diffuse_lighting;    // rgb: sky irradiance / pi, linear, >= 0; a: ambient occlusion, [0, 1]

layout(std140, set = 0, binding = 0) uniform View {
    vec4 sky_light_color;    // rgb: linear multiplier, >= 0
    vec4 light_direction;    // xyz: unit vector towards the main light
};

layout(location = 0) out vec4 color;                            // rgb: radiance
layout(location = 1) out vec4 water_diffuse_indirect_luminance;    // rgb: kept apart for the water's own scattering

void main() {
    vec3 lit = vec3(0.0);
    vec3 water = vec3(0.0);

#if ENABLE_SKY_LIGHT
#if MATERIAL_TWOSIDED && LQ_TEXTURE_LIGHTMAP
    // The low-quality lightmap of a two-sided surface holds the light of the front alone: sky light fills in the back.
    const bool receives_sky = dot(world_normal, light_direction.xyz) <= 0.0;
#else
    const bool receives_sky = true;
#endif
    if (receives_sky) {
        const vec3 sky = sky_diffuse_lighting.rgb;
#if MATERIAL_SHADINGMODEL_SINGLELAYERWATER
        water += sky;
#endif
        lit += sky * sky_light_color.rgb * diffuse_color * sky_diffuse_lighting.a;
    }
#endif

    color = vec4(lit, 1.0);
    water_diffuse_indirect_luminance = vec4(water, 1.0);
}
