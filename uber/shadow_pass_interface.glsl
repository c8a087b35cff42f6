// What shadow_pass's stages share with the renderer, one layout in every variant. Conventions: metres, column vectors, Vulkan
// clip space (y down, depth 0 to 1); perspective matrices have the view distance in clip w.

layout(std140, set = 0, binding = 0) uniform ShadowView {
    mat4 shadow_view_projection;    // world to clip of this map, cascade or cube face
    float moments_far;              // metres, > 0: distance that q = 1 - reference stands for; moments
    float moments_reference;        // [0, 1]: the middle of the scene's distances, in units of moments_far; moments
};

layout(std140, set = 2, binding = 0) uniform Object {
    mat4 model;    // object to world, affine
};

layout(push_constant) uniform Draw {
    float alpha_threshold;    // [0, 1]: what is less opaque casts no shadow; alpha_test
};
