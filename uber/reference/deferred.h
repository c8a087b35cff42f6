#pragma once
// uber/deferred.frag as a function: a texel of the g-buffer to what one full-screen pass adds there.

#include "uber/reference/screen.h"
#include "uber/reference/surface.h"

namespace kiln::reference {

// axes: light, shadow, cascades, ibl and reflection count. g: as surface_gbuffer gives it, or as a format has kept it; depth:
// [0, 1], 1 where nothing is. world_of_clip: inverse of b.view_projection, of fp32; uv: of the pixel's centre, v down.
template <class T, class Maps>
Vec3<T> deferred_radiance(SurfaceAxes axes, const SurfaceBlocks& b, const Maps& maps, const Mat4<double>& world_of_clip,
                          const SurfaceGbuffer<T>& g, const T& depth, const Vec2<T>& uv) {
    if (!(depth < T(1))) return splat3(T(0));
    const bool ggx = g.diffuse.w > T(0.5), baked = g.irradiance.w > T(0.5);
    SurfaceShading<T> s;
    s.diffuse = g.diffuse.xyz();
    s.specular = g.specular.xyz();
    s.roughness = g.specular.w;
    if (axes.light == SurfaceLight::none && !axes.ibl) return s.diffuse * g.irradiance.xyz();
    const Vec3<T> position = screen_to_world(read<T>(world_of_clip), uv, depth), n = decode_octahedral(g.normal.xy());
    const Vec3<T> v = safe_normalize(read<T>(b.camera_position) - position, n);
    if (axes.light == SurfaceLight::none) {
        if (!ggx) s.specular = splat3(T(0));
        return environment_light(axes, b, maps, position, n, v, s, baked ? g.irradiance.xyz() * T(pi) : sky_irradiance(b, n));
    }
    const Vec3<T> l = direction_to_light(axes, b, position);
    const Vec3<T> reflected = ggx ? cook_torrance(n, v, l, s.diffuse, s.specular, s.roughness)
                                  : blinn_phong(n, v, l, s.diffuse, s.specular, blinn_phong_shininess(s.roughness));
    const Vec3<T> geometric = decode_octahedral(Vec2<T>{g.normal.z, g.normal.w});
    return reflected * light_irradiance(axes, b, position, l) * light_visibility(axes, b, maps, position, geometric, l);
}

}  // namespace kiln::reference
