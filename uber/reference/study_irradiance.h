#pragma once
// Diffuse light from a few numbers a place, as uber/study_irradiance.frag has it: axes by the names of their values.

#include <array>
#include <string>

#include "uber/reference/bounded.h"
#include "uber/reference/environment.h"
#include "uber/reference/probes.h"
#include "uber/reference/sh.h"
#include "uber/reference/sh_lightmap.h"
#include "uber/reference/study_sphere.h"
#include "uber/reference/texture.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

struct IrradianceAxes {
    std::string irradiance, probes;
};

struct IrradianceBlock {
    std::array<Vec3<double>, 72> probe_sh;
    std::array<Vec3<double>, 4> tetrahedron_corner;
    Vec3<double> grid_first, grid_spacing;
};

// The weight of each of eight probes.
template <class T>
std::array<T, 8> probe_weights(const IrradianceAxes& axes, const IrradianceBlock& b, const Vec3<T>& position, const Vec3<T>& n) {
    const auto vector = [](const Vec3<double>& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    std::array<T, 8> out{T(1), T(0), T(0), T(0), T(0), T(0), T(0), T(0)};
    if (axes.probes == "single") return out;
    const auto facing = [&](const Vec3<T>& place) { return probe_facing_weight(safe_normalize(place - position, n), n); };
    if (axes.probes.rfind("trilinear", 0) == 0) {
        // Of two probes an axis there is one cell.
        const Vec3<T> spacing = vector(b.grid_spacing), first = vector(b.grid_first);
        out = trilinear_weights(saturate((position - first) * (splat3(T(1)) / spacing)));
        if (axes.probes == "trilinear") return out;
        T total(0);
        for (size_t i = 0; i < 8; ++i) {
            const double x = static_cast<double>(i & 1), y = static_cast<double>(i >> 1 & 1), z = static_cast<double>(i >> 2);
            out[i] = out[i] * facing(first + Vec3<T>{T(x), T(y), T(z)} * spacing);
            total = total + out[i];
        }
        for (T& w : out) w = w / total;
        return out;
    }
    const auto corner = [&](size_t i) { return vector(b.tetrahedron_corner[i]); };
    Vec4<T> w = tetrahedron_weights(position, corner(0), corner(1), corner(2), corner(3));
    if (axes.probes == "tetrahedral_facing")
        w = {max(w.x, T(0)) * facing(corner(0)), max(w.y, T(0)) * facing(corner(1)), max(w.z, T(0)) * facing(corner(2)),
             max(w.w, T(0)) * facing(corner(3))};
    w = normalize_weights(w);
    return {w.x, w.y, w.z, w.w, T(0), T(0), T(0), T(0)};
}

// E / pi. map(d, layer, level): the irradiance map, E / pi.
template <class T, class Map>
Vec3<T> study_irradiance(const IrradianceAxes& axes, const IrradianceBlock& b, const Map& map, const Vec2<T>& uv) {
    if (!on_sphere(uv)) return splat3(T(0));
    const Vec3<T> n = sphere_normal(uv);
    const std::string& form = axes.irradiance;
    if (form == "cube_map") return map(n, 0, T(0));
    const std::array<T, 8> weights = probe_weights(axes, b, n, n);
    ShL2<T> l2;
    for (size_t k = 0; k < 9; ++k) {
        l2.c[k] = splat3(T(0));
        for (size_t i = 0; i < 8; ++i) {
            const Vec3<double>& c = b.probe_sh[9 * i + k];
            l2.c[k] = l2.c[k] + Vec3<T>{T(c.x), T(c.y), T(c.z)} * weights[i];
        }
    }
    const ShL1<T> l1{{l2.c[0], l2.c[1], l2.c[2], l2.c[3]}};
    const ShMomentsL1<T> m = sh_moments_of(l1);
    const auto irradiance = [&]() -> Vec3<T> {
        if (form == "sh_l2") return sh_irradiance_from_radiance(l2, n);
        if (form == "sh_l2_convolved") return sh_irradiance_convolved(sh_l2_convolve(l2), n);
        if (form == "sh_quadratic") {
            const auto channel = [&](auto pick) {
                std::array<T, 9> c;
                for (size_t k = 0; k < 9; ++k) c[k] = pick(l2.c[k]);
                return sh_quadratic_irradiance(sh_quadratic_matrix(c), n);
            };
            return {channel([](const Vec3<T>& v) { return v.x; }), channel([](const Vec3<T>& v) { return v.y; }),
                    channel([](const Vec3<T>& v) { return v.z; })};
        }
        if (form == "sh_l1") return sh_irradiance_from_radiance(l1, n);
        if (form == "sh_l1_convolved") return sh_irradiance_convolved(sh_l1_convolve(l1), n);
        if (form == "sh_l1_moments") return sh_irradiance_from_moments(m, n);
        if (form == "sh_l1_weighted") return sh_irradiance_from_weighted(sh_l1_weight(m), n);
        if (form == "sh_l1_clamped") return sh_irradiance_clamped(m, n);
        if (form == "sh_l1_nonlinear") return sh_irradiance_nonlinear(m, n);
        if (form == "sh_l1_zh3") return sh_irradiance_zh3(m, n);
        if (form == "sh_l1_zh3_luminance") return sh_irradiance_zh3_luminance(m, n);
        if (form == "sh_l1_lightmap") {
            const auto stored = [&](const Vec3<T>& m1) { return decode_sh_ratio(encode_sh_ratio(m.m0, m1)); };
            return sh_l1_irradiance(m.m0, stored(m.m1_y), stored(m.m1_z), stored(m.m1_x), n);
        }
        if (form == "lecture")
            return {sh_irradiance_lecture(Vec4<T>{l1.c[0].x, l1.c[1].x, l1.c[2].x, l1.c[3].x}, n),
                    sh_irradiance_lecture(Vec4<T>{l1.c[0].y, l1.c[1].y, l1.c[2].y, l1.c[3].y}, n),
                    sh_irradiance_lecture(Vec4<T>{l1.c[0].z, l1.c[1].z, l1.c[2].z, l1.c[3].z}, n)};
        // 0.25 and 0.5 are the weights of raw moments; printed, they meet coefficients.
        if (form == "lecture_merged") return l1.c[0] * T(0.25) + (l1.c[1] * n.y + l1.c[2] * n.z + l1.c[3] * n.x) * T(0.5);
        return sh_irradiance_clamped(l2, n);
    };
    return irradiance() / T(pi);
}

}  // namespace kiln::reference
