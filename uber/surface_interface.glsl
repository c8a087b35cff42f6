// What surface's two stages share with the renderer. Every block has one layout in all variants and every resource one
// slot. Sets by how often they change: 0 a view and its light, 1 a material, 2 an object; push constants a draw.
// Conventions: right-handed world space in metres, column vectors, Vulkan clip space (y down, depth 0 to 1).

layout(std140, set = 0, binding = 0) uniform View {
    mat4 view_projection;             // world to clip, with this frame's jitter
    mat4 previous_view_projection;    // of the last frame, with that frame's jitter
    vec4 jitter;                      // xy: this frame's offset of the projection in NDC, zw: the last frame's
    vec3 camera_position;             // world
    vec3 ambient_irradiance;          // W/m2 (or lux), on every receiver alike; [0, 1e26]
};

layout(std140, set = 0, binding = 1) uniform Light {
    vec3 light_position;      // world; point and spot
    float light_range;        // metres, > 0; the light ends here; point and spot
    vec3 light_direction;     // unit, the way the light travels; directional and spot
    float light_cos_inner;    // cosine of the half-angle of full light; spot
    vec3 light_intensity;     // linear rgb, [0, 1e26]; lux for directional, candela for point and spot
    float light_cos_outer;    // cosine of the half-angle where light ends; spot
};

layout(std140, set = 0, binding = 2) uniform Shadow {
    mat4 shadow_view_projection;    // world to the light's clip space, in w the view distance; directional and spot
    float shadow_near;              // metres, > 0; point; pcss, vssm
    float shadow_far;               // metres, > shadow_near; depth's range where directional; point; pcss, vssm
    float shadow_texel;             // metres; side of one shadow-map texel where the light's clip w is 1
    float shadow_depth_bias;        // in depth units, >= two quanta of the map: 4 / 65535 for D16
};

layout(std140, set = 1, binding = 0) uniform Material {
    vec4 base_factor;               // rgb: multiplies base_map; a: least opacity that is drawn; alpha_test
    vec4 specular_factor;           // rgb: multiplies specular_map; blinn_phong and pbr_sg
    vec3 emissive;                  // linear radiance, [0, 1e26]
    float dielectric_specular;      // [0, 1], 0.5 is F0 = 0.04; pbr_mr, disney's environment
    float shininess;                // Blinn-Phong exponent, [1, 2048]; blinn_phong
    float roughness_factor;         // multiplies roughness_map; pbr_mr, disney
    float metallic_factor;          // multiplies metallic_map; pbr_mr, disney
    float glossiness_factor;        // multiplies gloss_map; pbr_sg
};

layout(std140, set = 2, binding = 0) uniform Object {
    mat4 model;             // object to world, affine
    mat4 previous_model;    // of the last frame
};

layout(push_constant) uniform Draw {
    vec4 lightmap_rect;      // lightmap uv = uv * xy + zw: the draw's chart in the atlas
    float lightmap_range;    // irradiance of texel value 1 (flat); 1 for floating-point maps
};
