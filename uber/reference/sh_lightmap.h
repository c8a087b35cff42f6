#pragma once
// A lightmap with the first spherical-harmonics band, as uber/lib/sh_lightmap.glsl names it.
// Ramamoorthi and Hanrahan 2001; O'Donnell 2018.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
Vec3<T> decode_sh_ratio(const Vec3<T>& texel) {
    return texel * T(2) - splat3(T(1));
}

template <class T>
Vec3<T> encode_sh_ratio(const Vec3<T>& m0, const Vec3<T>& m1) {
    return saturate(splat3(T(0.5)) + m1 * T(0.5) / max(m0, splat3(T(1e-20))));
}
template <class T>
Vec3<T> decode_flat_lightmap(const Vec3<T>& texel, const T& range) {
    return texel * range;
}

// E(n) = m0 / 4 + (m1 . n) / 2 from raw moments, m1 given as m1 / m0; not below 0.
template <class T>
Vec3<T> sh_l1_irradiance(const Vec3<T>& m0, const Vec3<T>& ratio_y, const Vec3<T>& ratio_z, const Vec3<T>& ratio_x,
                         const Vec3<T>& n) {
    return m0 * max(splat3(T(0.25)) + (ratio_y * n.y + ratio_z * n.z + ratio_x * n.x) * T(0.5), splat3(T(0)));
}

}  // namespace kiln::reference
