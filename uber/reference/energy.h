#pragma once
// Light that single scattering loses, as uber/lib/energy.glsl names it.

#include "uber/reference/fresnel.h"

namespace kiln::reference {

template <class T>
Vec3<T> multiscatter_scale(const Vec3<T>& f0, const T& e) {
    return splat3(T(1)) + f0 * (T(1) / clamp(e, T(1e-3), T(1)) - T(1));
}

template <class T>
Vec3<T> single_scatter_albedo(const Vec3<T>& f0, const Vec2<T>& dfg) {
    return f0 * dfg.x + splat3(fresnel_f90(f0) * dfg.y);
}

// Fdez-Aguera 2019.
template <class T>
Vec3<T> multiple_scatter_albedo(const Vec3<T>& f0, const Vec2<T>& dfg) {
    const T lost = T(1) - saturate(dfg.x + dfg.y);
    const Vec3<T> average = fresnel_average(f0);
    return single_scatter_albedo(f0, dfg) * lost * average / max(splat3(T(1)) - average * lost, splat3(T(1e-3)));
}

template <class T>
Vec3<T> diffuse_below(const Vec3<T>& f0, const Vec2<T>& dfg) {
    return max(splat3(T(1)) - single_scatter_albedo(f0, dfg) - multiple_scatter_albedo(f0, dfg), splat3(T(0)));
}

// Kulla and Conty 2017.
template <class T>
Vec3<T> multiscatter_lobe(const T& e_l, const T& e_v, const T& e_avg, const Vec3<T>& f_avg) {
    const T lost = max(T(1) - e_avg, T(1e-6));
    const Vec3<T> coloured = f_avg * f_avg * e_avg / (splat3(T(1)) - f_avg * (T(1) - e_avg));
    return coloured * ((T(1) - e_l) * (T(1) - e_v) / (T(pi) * lost));
}

}  // namespace kiln::reference
