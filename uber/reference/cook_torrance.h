#pragma once
// Lambert below a GGX coat, as uber/lib/cook_torrance.glsl names it. Cook and Torrance 1982; Shirley et al. 1997.

#include "uber/reference/fresnel.h"
#include "uber/reference/ggx.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

// What a coat reflects beyond F(n.v), of F90: at most this.
template <class T>
T rough_coat_surplus(const T& alpha) {
    const T flat_share = T(1) - alpha;
    return T(0.028) * alpha * flat_share * flat_share;
}

// ((1 - F(n.l)) (1 - F(n.v)) / (1 - Favg) (1 - s F90) diffuse / pi + D V F(v.h)) n.l
template <class T>
Vec3<T> cook_torrance(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& diffuse, const Vec3<T>& f0,
                      const T& roughness) {
    const T n_dot_l = saturate(dot(n, l)), n_dot_v = clamp(dot(n, v), T(1e-4), T(1));
    const Vec3<T> h = safe_normalize(v + l, n);
    const T alpha = ggx_alpha(roughness);
    const T lobe = ggx_distribution(n, h, alpha) * ggx_visibility(max(n_dot_l, T(1e-4)), n_dot_v, alpha);
    const Vec3<T> one = splat3(T(1));
    const Vec3<T> passed = (one - fresnel_schlick(n_dot_l, f0)) * (one - fresnel_schlick(n_dot_v, f0)) /
                           max(one - fresnel_average(f0), splat3(T(1e-4))) * (T(1) - rough_coat_surplus(alpha) * fresnel_f90(f0));
    return (passed * diffuse / T(pi) + fresnel_schlick(dot(v, h), f0) * lobe) * n_dot_l;
}

}  // namespace kiln::reference
