#pragma once
// Light that leaves elsewhere than it entered, as uber/study_subsurface.frag has it: the form by its name in
// manifests/library.yaml.

#include <string>

#include "uber/reference/bounded.h"
#include "uber/reference/study_sphere.h"
#include "uber/reference/subsurface.h"
#include "uber/reference/subsurface_preintegrated.h"
#include "uber/reference/subsurface_separable.h"
#include "uber/reference/texture.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

struct SubsurfaceBlock {
    Vec3<double> lamp_bearing, surface_albedo, free_path, scattering, absorption;
    double wrap = 0, curvature = 0, picture_width = 0, index = 0, turn = 0;
};

struct SubsurfaceMaps {
    Texture2D preintegrated_table, irradiance_picture;
};

template <class T>
Vec3<T> study_subsurface(const std::string& form, const SubsurfaceBlock& b, const SubsurfaceMaps& maps, const Vec2<T>& uv) {
    constexpr int burley_taps = 16, ring_steps = 8, separable_taps = 9;  // as the shader has them
    const auto vector = [](const Vec3<double>& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> albedo = vector(b.surface_albedo), path = vector(b.free_path), s = burley_shape_diffuse(albedo) / path;
    const T width(b.picture_width), curvature(b.curvature), smallest = min(min(s.x, s.y), s.z);
    if (form == "wrap" || form.rfind("preintegrated", 0) == 0) {
        if (!on_sphere(uv)) return splat3(T(0));
        const T n_dot_l = dot(sphere_normal(uv), safe_normalize(vector(b.lamp_bearing), sphere_viewer<T>()));
        const auto lit = [&]() -> Vec3<T> {
            if (form == "preintegrated_table") {
                const Vec2<T> size{T(static_cast<double>(maps.preintegrated_table.width())),
                                   T(static_cast<double>(maps.preintegrated_table.height()))};
                return preintegrated_lookup([&](const Vec2<T>& at) { return maps.preintegrated_table.channel(at, 0); }, size,
                                            n_dot_l, curvature, s);
            }
            if (form == "preintegrated_sphere")
                return map(s, [&](const T& shape) { return preintegrated_sphere(n_dot_l, curvature / shape, ring_steps); });
            if (form == "preintegrated_ring")
                return map(s, [&](const T& shape) {
                    return preintegrated_ring(n_dot_l, curvature, burley_gaussian_variance(shape), ring_steps);
                });
            return splat3(wrap_diffuse(n_dot_l, T(b.wrap)));
        };
        return albedo * lit();
    }
    const auto picture = [&](const Vec2<T>& at) { return maps.irradiance_picture.rgb(at); };
    const T across = T(1) / width;
    if (form == "gather_burley")
        return albedo * burley_gather(picture, uv, Vec2<T>{across, across}, s, smallest, T(b.turn), burley_taps);
    if (form == "separable_burley")
        return albedo *
               separable_gather(picture, uv, Vec2<T>{across, T(0)}, separable_kernel_burley(s, T(9) / smallest, separable_taps));
    if (form == "separable_skin")
        return albedo * separable_gather(picture, uv, Vec2<T>{across, T(0)},
                                         separable_kernel_skin(vector(b.scattering), vector(b.absorption), separable_taps));
    const Vec2<T> from_centre{(uv.x - T(0.5)) * width, (uv.y - T(0.5)) * width};
    const T r = length(from_centre);
    if (form == "profile_searchlight") return albedo * burley_profile(r, burley_shape_searchlight(albedo) / path);
    if (form == "profile_mean_free_path") return albedo * burley_profile(r, burley_shape_mean_free_path(albedo) / path);
    if (form == "profile_dipole")
        return dipole_profile(r, vector(b.scattering), vector(b.absorption), dipole_boundary(clamp(T(b.index), T(1), T(2))));
    return albedo * burley_profile(r, s);
}

}  // namespace kiln::reference
