#pragma once
// From what artists paint to what the BRDFs take, as uber/lib/materials.glsl names it. Burley 2012; Karis 2013.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> metallic_diffuse(const Vec3<T>& base, const T& metallic) {
    return base * (T(1) - saturate(metallic));
}

template <class T>
Vec3<T> metallic_f0(const Vec3<T>& base, const T& metallic, const T& dielectric_specular) {
    return mix(splat3(T(0.08) * saturate(dielectric_specular)), base, saturate(metallic));
}

template <class T>
Vec3<T> reflectance(const Vec3<T>& texel, const Vec3<T>& factor) {
    return saturate(texel * factor);
}

}  // namespace kiln::reference
