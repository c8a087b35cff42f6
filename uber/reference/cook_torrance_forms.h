#pragma once
// The cheap form of cook_torrance.h, as uber/lib/cook_torrance_forms.glsl names it.

#include "uber/reference/fresnel.h"
#include "uber/reference/ggx.h"
#include "uber/reference/smith.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

// ((1 - Favg) diffuse / pi + D V F(v.h)) n.l, V Hammon's.
template <class T>
Vec3<T> cook_torrance_hammon(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& diffuse, const Vec3<T>& f0,
                             const T& roughness) {
    const T n_dot_l = saturate(dot(n, l)), n_dot_v = clamp(dot(n, v), T(1e-4), T(1));
    const Vec3<T> h = safe_normalize(v + l, n);
    const T alpha = ggx_alpha(roughness);
    const T lobe = ggx_distribution(n, h, alpha) * visibility_hammon(max(n_dot_l, T(1e-4)), n_dot_v, alpha);
    return ((splat3(T(1)) - fresnel_average(f0)) * diffuse / T(pi) + fresnel_schlick(dot(v, h), f0) * lobe) * n_dot_l;
}

}  // namespace kiln::reference
