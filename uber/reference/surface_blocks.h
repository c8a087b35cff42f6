#pragma once
// What surface's variants are and read: axes by value, blocks as the renderer fills them, what the vertex stage hands over.

#include "uber/reference/depth_map.h"
#include "uber/reference/numbers.h"

namespace kiln::reference {

// Values in the order of manifests/renderer.yaml.
enum class SurfaceLight { none, directional, point, spot };
enum class SurfaceMaterial { blinn_phong, pbr_mr, pbr_sg, disney, blinn_phong_raw, blinn_phong_lecture, pbr_lecture };
enum class SurfaceLightmap { none, flat, sh_lq, sh_hq, sh_lecture };
enum class SurfaceShadow { none, hard, pcf3, pcf5, pcf7, pcss, vsm, vssm, lecture };
enum class SurfaceProbes { none, sh_l1, sh_l2 };
enum class SurfaceReflection { none, box, blended };

struct SurfaceAxes {
    SurfaceLight light = SurfaceLight::none;
    SurfaceMaterial material = SurfaceMaterial::blinn_phong;
    SurfaceLightmap lightmap = SurfaceLightmap::none;
    SurfaceShadow shadow = SurfaceShadow::none;
    SurfaceProbes probes = SurfaceProbes::none;
    SurfaceReflection reflection = SurfaceReflection::none;
    int cascades = 1;
    bool ibl = false, two_sided = false, alpha_test = false, normal_map = false, hammon = false;
    bool mediump = false, additive = false;
};

// Every number is one of fp32, since that is what the device reads.
struct SurfaceBlocks {
    Mat4<double> view_projection, previous_view_projection;
    Vec4<double> jitter;
    Vec3<double> camera_position, ambient_irradiance;

    Vec3<double> light_position, light_direction, light_intensity;
    double light_range = 1, light_cos_inner = 1, light_cos_outer = 0;

    Mat4<double> shadow_view_projection;
    double shadow_near = 1, shadow_far = 2, shadow_texel = 0, shadow_depth_bias = 0;
    Mat4<double> shadow_plane_of_world;
    double shadow_texel_uv = 0, shadow_filter = 0, shadow_quantum = 0, light_size = 0, shadow_extent = 1;
    double moments_far = 1, moments_reference = 0, moments_least = 1e-9, moments_bleeding = 0, moments_levels = 1;
    Mat4<double> cascade_view_projection[4], cascade_plane_of_world[4];
    Vec4<double> cascade_ends, cascade_texel, cascade_bias, cascade_filter;
    double cascade_start = 0, cascade_band = 0, cascade_texel_uv = 0, cascade_quantum = 0;

    Vec4<double> base_factor, specular_factor;
    Vec3<double> emissive;
    double dielectric_specular = 0.5, shininess = 1, roughness_factor = 1, metallic_factor = 1, glossiness_factor = 1;
    double disney_subsurface_share = 0, disney_specular_level = 0.5, disney_specular_tint = 0, disney_sheen = 0,
           disney_sheen_tint = 0, disney_coat = 0, disney_coat_gloss = 0;

    Mat4<double> model, previous_model;
    Vec4<double> lightmap_rect;
    double lightmap_range = 1;
    Vec3<double> probe_first, probe_inverse_spacing;
    int probe_count[3] = {1, 1, 1};
    Vec3<double> probe_sh[576];

    Vec3<double> sky_sh[9];
    double environment_levels = 1, split_sum_size = 2;
    Vec4<double> reflection_box_min[2], reflection_box_max[2], reflection_centre[2];
    int reflection_layer[2] = {0, 0};
};

template <class T>
Vec3<T> read(const Vec3<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
Vec4<T> read(const Vec4<double>& v) {
    return {T(v.x), T(v.y), T(v.z), T(v.w)};
}
template <class T>
Mat4<T> read(const Mat4<double>& m) {
    return {{read<T>(m.columns[0]), read<T>(m.columns[1]), read<T>(m.columns[2]), read<T>(m.columns[3])}};
}

template <class T>
struct SurfaceVaryings {
    Vec3<T> world_position, world_normal;
    Vec2<T> material_uv, atlas_uv;
    Vec4<T> world_tangent;
    Vec4<T> clip_position, previous_clip_position;
};

// What a mediump variant may make of a number: half an ulp of fp16's 2^-10, and nothing under 2^-14 (Vulkan specification,
// "RelaxedPrecision").
template <class T>
T relaxed(const SurfaceAxes& axes, const T& x) {
    return axes.mediump ? loosened(x, 0x1p-10 * std::fabs(value(x)) + 0x1p-14) : x;
}
template <class T>
Vec3<T> relaxed(const SurfaceAxes& axes, const Vec3<T>& v) {
    return {relaxed(axes, v.x), relaxed(axes, v.y), relaxed(axes, v.z)};
}

}  // namespace kiln::reference
