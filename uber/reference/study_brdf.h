#pragma once
// What a sphere reflects of a small light nearby, as uber/study_brdf.frag has it: axes by the names of their values in
// manifests/library.yaml.

#include <array>
#include <string>
#include <vector>

#include "uber/reference/blinn_phong.h"
#include "uber/reference/blinn_phong_raw.h"
#include "uber/reference/bounded.h"
#include "uber/reference/cook_torrance.h"
#include "uber/reference/cook_torrance_forms.h"
#include "uber/reference/disney.h"
#include "uber/reference/energy.h"
#include "uber/reference/fresnel_exact.h"
#include "uber/reference/fresnel_fits.h"
#include "uber/reference/ggx_forms.h"
#include "uber/reference/gtr.h"
#include "uber/reference/ibl.h"
#include "uber/reference/lecture_brdf.h"
#include "uber/reference/merl.h"
#include "uber/reference/smith.h"
#include "uber/reference/study_sphere.h"
#include "uber/reference/texture.h"

namespace kiln::reference {

struct BrdfAxes {
    std::string model, distribution, visibility, fresnel, diffuse, energy, parameters;
};

struct BrdfBlock {
    Vec3<double> lamp_bearing, lamp_brightness, base_colour, fresnel_edge, eta, k;
    double lamp_height = 0, roughness = 0, metallic = 0, dielectric_specular = 0, shininess = 0, albedo_average = 0,
           split_sum_size = 0, ior = 0, subsurface = 0, sheen = 0, specular_tint = 0, sheen_tint = 0, clearcoat = 0,
           clearcoat_gloss = 0;
};

// Four floats a texel, as uber/lib/merl.glsl lays them out.
struct MerlTable {
    std::vector<float> texels;
    Vec4<double> texel(int theta_h, int theta_d, int column) const {
        const size_t at = 4 * static_cast<size_t>((theta_h * merl_theta_d_bins + theta_d) * (merl_phi_d_bins + 2) + column);
        return {static_cast<double>(texels[at]), static_cast<double>(texels[at + 1]), static_cast<double>(texels[at + 2]),
                static_cast<double>(texels[at + 3])};
    }
    template <class T>
    Vec4<T> bin(int theta_h, int theta_d, int phi_d) const {
        const Vec4<double> v = texel(theta_h, theta_d, phi_d + 1);
        return {T(v.x), T(v.y), T(v.z), T(v.w)};
    }
};

struct BrdfMaps {
    Texture2D split_sum_table;
    MerlTable merl;
};

template <class T>
Vec3<T> study_vector(const Vec3<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
}

template <class T>
Vec3<T> merl_of(const std::string& form, const BrdfMaps& maps, const Vec3<T>& c) {
    const auto bin = [&](int h, int d, int p) { return maps.merl.bin<T>(h, d, p); };
    if (form == "merl_nearest") {
        for (const T& x : {c.x, c.y, c.z}) (void)floor(x);  // which bin may be too close to call
        return merl_lookup_nearest(bin, c);
    }
    if (form == "merl_linear") return merl_lookup(bin, c);
    // A sampler of its own weights between the same bins, in the texture's columns.
    const Vec3<double> at{std::clamp(value(c.x) - 0.5, 0.0, 89.0), std::clamp(value(c.y) - 0.5, 0.0, 89.0), value(c.z) + 0.5};
    const int h = static_cast<int>(at.x), d = static_cast<int>(at.y), p = static_cast<int>(at.z);
    const auto weight = [](const T& x, double inside, int low) { return loosened(T(inside - low), error_of(x) + texel_step); };
    const auto mixed = [](const Vec4<T>& a, const Vec4<T>& b, const T& t) {
        return Vec4<T>{mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t), mix(a.w, b.w, t)};
    };
    const auto texel = [&](int i, int j, int k) {
        const Vec4<double> v = maps.merl.texel(std::min(i, 89), std::min(j, 89), std::min(k, 181));
        return Vec4<T>{T(v.x), T(v.y), T(v.z), T(v.w)};
    };
    const T x = weight(c.x, at.x, h), y = weight(c.y, at.y, d), z = weight(c.z, at.z, p);
    const auto row = [&](int i, int j) { return mixed(texel(i, j, p), texel(i, j, p + 1), z); };
    const auto plane = [&](int i) { return mixed(row(i, d), row(i, d + 1), y); };
    return merl_measured(mixed(plane(h), plane(h + 1), x));
}

template <class T>
Vec3<T> brdf_microfacets(const BrdfAxes& axes, const BrdfBlock& b, const BrdfMaps& maps, const Vec3<T>& n, const Vec3<T>& v,
                         const Vec3<T>& l, const Vec3<T>& base, const Vec3<T>& f0) {
    const Vec3<T> h = safe_normalize(v + l, n);
    const T roughness(b.roughness), alpha = axes.parameters == "pushed" ? ggx_alpha_pushed(roughness) : ggx_alpha(roughness);
    const T n_dot_l = saturate(dot(n, l)), n_dot_v = clamp(dot(n, v), T(1e-4), T(1)), v_dot_h = dot(v, h);
    const T lit = max(n_dot_l, T(1e-4));
    const auto distribution = [&](const std::string& form) {
        if (form == "ggx") return ggx_distribution(n, h, alpha);
        if (form == "ggx_cross") return ggx_distribution_cross(n, h, alpha);
        if (form == "ggx_cosine") return ggx_distribution_cosine(dot(n, h), alpha);
        if (form == "ggx_sine") {
            const Vec3<T> across = cross(n, h);
            return ggx_from_sine(saturate(dot(n, h)), saturate(dot(across, across)), alpha);
        }
        if (form == "gtr1") return gtr1_distribution(n, h, alpha);
        return ggx_distribution_lecture(saturate(dot(n, h)), roughness);
    };
    const auto visibility = [&](const std::string& form) {
        if (form == "height_correlated") return ggx_visibility(lit, n_dot_v, alpha);
        if (form == "height_correlated_pushed") return visibility_height_correlated_pushed(lit, n_dot_v, alpha);
        if (form == "separable") return visibility_separable(lit, n_dot_v, alpha);
        if (form == "karis_direct") return visibility_karis_direct(lit, n_dot_v, saturate(roughness));
        if (form == "karis_ibl") return visibility_karis_ibl(lit, n_dot_v, alpha);
        if (form == "hammon") return visibility_hammon(lit, n_dot_v, alpha);
        if (form == "kelemen") return visibility_kelemen(v_dot_h);
        if (form == "implicit") return visibility_implicit<T>();
        return smith_lecture(n_dot_v, lit, roughness) / (T(4) * n_dot_v * lit + T(0.001));
    };
    const auto fresnel = [&](const std::string& form) {
        const Vec3<T> edge = study_vector<T>(b.fresnel_edge);
        if (form == "schlick") return fresnel_schlick(v_dot_h, f0);
        if (form == "schlick_pow") return fresnel_schlick_pow(v_dot_h, f0);
        if (form == "schlick_f90") return fresnel_schlick_f90(v_dot_h, f0, edge);
        if (form == "schlick_pushed") return fresnel_schlick_pushed(v_dot_h, f0);
        if (form == "spherical_gaussian") return fresnel_spherical_gaussian(v_dot_h, f0);
        if (form == "f82") return fresnel_f82(v_dot_h, f0, edge);
        if (form == "dielectric") return splat3(fresnel_dielectric(v_dot_h, T(b.ior)));
        if (form == "conductor") return fresnel_conductor(v_dot_h, study_vector<T>(b.eta), study_vector<T>(b.k));
        return fresnel_schlick_lecture(saturate(v_dot_h), f0);
    };
    Vec3<T> f = fresnel(axes.fresnel) * (distribution(axes.distribution) * visibility(axes.visibility));

    const auto albedo = [&](const T& cosine) {
        const Vec2<T> ab = split_sum_lookup([&](const Vec2<T>& uv) { return maps.split_sum_table(uv).xy(); }, cosine, roughness,
                                            T(b.split_sum_size));
        return saturate(ab.x + ab.y);
    };
    if (axes.energy == "scaled") f = f * multiscatter_scale(f0, albedo(n_dot_v));
    if (axes.energy == "kulla_conty")
        f = f + multiscatter_lobe(albedo(n_dot_l), albedo(n_dot_v), T(b.albedo_average), fresnel_average(f0));

    const T l_dot_h = saturate(v_dot_h), r = saturate(roughness);
    if (axes.diffuse == "lambert") f = f + base / T(pi);
    if (axes.diffuse == "disney") f = f + base / T(pi) * disney_diffuse(n_dot_l, n_dot_v, l_dot_h, r);
    if (axes.diffuse == "disney_renormalised") f = f + base / T(pi) * disney_diffuse_renormalised(n_dot_l, n_dot_v, l_dot_h, r);
    if (axes.diffuse == "disney_subsurface") f = f + base / T(pi) * disney_subsurface(n_dot_l, n_dot_v, l_dot_h, r);
    return f * n_dot_l;
}

template <class T>
Vec3<T> study_brdf(const BrdfAxes& axes, const BrdfBlock& b, const BrdfMaps& maps, const Vec2<T>& uv) {
    if (!on_sphere(uv)) return splat3(T(0));
    const Vec3<T> n = sphere_normal(uv), v = sphere_viewer<T>();
    const Vec3<T> lamp = safe_normalize(study_vector<T>(b.lamp_bearing), v) * (T(2) + T(b.lamp_height));
    const Vec3<T> l = safe_normalize(lamp - n, n);
    const MetallicRoughness<T> painted{study_vector<T>(b.base_colour), n, T(b.roughness), T(b.metallic)};
    const T level(b.dielectric_specular), roughness(b.roughness), shininess(b.shininess);
    const SpecularGlossiness<T> m = axes.parameters == "pushed"    ? metallic_to_specular_pushed(painted, level)
                                    : axes.parameters == "lecture" ? metallic_to_specular_lecture(painted, level)
                                                                   : metallic_to_specular(painted, level);
    const auto model = [&](const std::string& form) {
        if (form == "microfacets") return brdf_microfacets(axes, b, maps, n, v, l, m.diffuse, m.specular);
        if (form == "cook_torrance") return cook_torrance(n, v, l, m.diffuse, m.specular, roughness);
        if (form == "cook_torrance_hammon") return cook_torrance_hammon(n, v, l, m.diffuse, m.specular, roughness);
        if (form == "cook_torrance_lecture")
            return cook_torrance_lecture(SpecularGlossiness<T>{m.specular, m.diffuse, n, T(1) - roughness}, v, l, T(1)) *
                   saturate(dot(n, l));
        if (form == "blinn_phong") return blinn_phong(n, v, l, m.diffuse, m.specular, shininess);
        if (form == "blinn_phong_raw") return blinn_phong_raw(n, v, l, m.diffuse, m.specular, shininess);
        if (form == "blinn_phong_lecture") return blinn_phong_lecture(n, v, l, m.diffuse, m.specular, shininess);
        if (form == "disney") {
            DisneyMaterial<T> d;
            d.base = painted.base_color;
            d.metallic = painted.metallic;
            d.subsurface = T(b.subsurface);
            d.specular = level;
            d.roughness = roughness;
            d.specular_tint = T(b.specular_tint);
            d.sheen = T(b.sheen);
            d.sheen_tint = T(b.sheen_tint);
            d.clearcoat = T(b.clearcoat);
            d.clearcoat_gloss = T(b.clearcoat_gloss);
            return disney_brdf(n, v, l, d);
        }
        const Vec3<T> at = merl_coordinates(n, l, safe_normalize(v + l, n));
        return merl_of(form, maps, at) * saturate(dot(n, l));
    };
    return model(axes.model) * (study_vector<T>(b.lamp_brightness) * T(pi));
}

}  // namespace kiln::reference
