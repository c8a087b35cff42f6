#pragma once
// Image-based light on a sphere, as uber/study_environment.frag has it: axes by the names of their values.

#include <string>

#include "uber/reference/bounded.h"
#include "uber/reference/environment.h"
#include "uber/reference/ggx.h"
#include "uber/reference/ibl.h"
#include "uber/reference/ibl_bake.h"
#include "uber/reference/probes.h"
#include "uber/reference/smith.h"
#include "uber/reference/study_sphere.h"
#include "uber/reference/texture.h"

namespace kiln::reference {

struct EnvironmentAxes {
    std::string reflection, split_sum, scatter;
};

struct EnvironmentBlock {
    Vec3<double> diffuse_albedo, f0, box_extent, probe_irradiance;
    double roughness = 0, environment_levels = 0, split_sum_size = 0, brightest = 0;
};

struct EnvironmentMaps {
    CubeArray environment_map, plain_map, irradiance_map;
    Texture2D split_sum_table, sky_picture;  // the picture has one level
};

// The shader's mean over 16 points, over any T.
template <class T, class V, class F>
Vec2<T> split_sum_of_points(const T& n_dot_v, const T& alpha, V visibility, F fresnel_weight) {
    constexpr uint32_t count = 16;
    const T cosine = clamp(n_dot_v, T(1e-4), T(1));
    const Vec3<T> v{sqrt(T(1) - cosine * cosine), T(0), cosine};
    Vec2<T> sum{T(0), T(0)};
    for (uint32_t i = 0; i < count; ++i) {
        const Vec2<double> u = hammersley(i, count);
        const Vec3<T> h = sample_ggx_half(Vec2<T>{T(u.x), T(u.y)}, alpha);
        const T v_dot_h = dot(v, h), n_dot_l = T(2) * v_dot_h * h.z - cosine;
        if (!(n_dot_l > T(0))) continue;
        const T weight = T(4) * visibility(n_dot_l, cosine) * n_dot_l * v_dot_h / h.z, fc = fresnel_weight(n_dot_l, v_dot_h);
        sum = sum + Vec2<T>{T(1) - fc, fc} * weight;
    }
    return sum / T(static_cast<double>(count));
}

template <class T>
Vec2<T> study_split_sum(const EnvironmentAxes& axes, const EnvironmentBlock& b, const EnvironmentMaps& maps, const T& n_dot_v) {
    const T roughness(b.roughness), alpha = ggx_alpha(roughness);
    const auto fifth = [](const T& x) { return x * x * x * x * x; };
    const auto schlick = [&](const T&, const T& v_dot_h) { return fifth(T(1) - saturate(v_dot_h)); };
    const auto correlated = [&](const T& l, const T& v) { return ggx_visibility(l, v, alpha); };
    if (axes.split_sum == "fit") return split_sum_fit(n_dot_v, roughness);
    if (axes.split_sum == "sampled") return split_sum_of_points(n_dot_v, alpha, correlated, schlick);
    if (axes.split_sum == "sampled_karis")
        return split_sum_of_points(
            n_dot_v, alpha, [&](const T& l, const T& v) { return visibility_karis_ibl(l, v, alpha); }, schlick);
    if (axes.split_sum == "lecture")
        return split_sum_of_points(n_dot_v, alpha, correlated,
                                   [&](const T& n_dot_l, const T&) { return pow(T(1) - min(n_dot_l, T(1)), T(5)); });
    return split_sum_lookup([&](const Vec2<T>& uv) { return maps.split_sum_table(uv).xy(); }, n_dot_v, roughness,
                            T(b.split_sum_size));
}

template <class T>
Vec3<T> study_environment(const EnvironmentAxes& axes, const EnvironmentBlock& b, const EnvironmentMaps& maps,
                          const Vec2<T>& uv) {
    if (!on_sphere(uv)) return splat3(T(0));
    const auto vector = [](const Vec3<double>& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> n = sphere_normal(uv), v = sphere_viewer<T>();
    const Vec3<T> over_pi = maps.irradiance_map(n, 0, T(0));
    const T roughness(b.roughness), level = environment_lod(roughness, T(b.environment_levels));
    const auto reflected = [&]() -> Vec3<T> {
        const Vec3<T> r =
            axes.reflection == "lecture_direction" ? environment_reflection_lecture(n, v) : environment_reflection(n, v);
        if (axes.reflection == "plain_mips") return maps.plain_map(r, 0, level);
        if (axes.reflection == "lecture_level") return maps.plain_map(r, 0, T(0));  // of a map with one level
        if (axes.reflection == "equirect")
            return sample_equirect([&](const Vec2<T>& at, const T&) { return maps.sky_picture.rgb(at); }, r, level,
                                   T(static_cast<double>(maps.sky_picture.height())));
        if (axes.reflection == "box")
            return maps.environment_map(box_projected_direction(n, r, -vector(b.box_extent), vector(b.box_extent), splat3(T(0))),
                                        0, level);
        const Vec3<T> seen = maps.environment_map(r, 0, level);
        if (axes.reflection == "normalised")
            return probe_normalized_reflection(seen, over_pi * T(pi), vector(b.probe_irradiance), T(b.brightest));
        return seen;
    };
    const Vec3<T> prefiltered = reflected(), diffuse = vector(b.diffuse_albedo), f0 = vector(b.f0);
    const Vec2<T> ab = study_split_sum(axes, b, maps, n.z);
    if (axes.scatter == "single") return diffuse * over_pi + environment_specular(prefiltered, f0, ab);
    if (axes.scatter == "scaled") return diffuse * over_pi + environment_specular_multiscatter(prefiltered, f0, ab);
    return image_based_light(diffuse, f0, over_pi, prefiltered, ab);
}

}  // namespace kiln::reference
