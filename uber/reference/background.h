#pragma once
// uber/background.frag as a function: what is seen at infinity through a place of the screen.

#include "uber/reference/environment.h"
#include "uber/reference/screen.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

template <class T>
struct Background {
    Mat4<T> world_of_clip;
    T sky_intensity{}, sky_level{};
};

template <class T>
Vec3<T> background_direction(const Background<T>& b, const Vec2<T>& uv) {
    return safe_normalize(screen_ray(b.world_of_clip, uv), Vec3<T>{T(0), T(1), T(0)});
}

// cube(direction, level).
template <class T, class Cube>
Vec3<T> background_of_cube(const Background<T>& b, const Cube& cube, const Vec2<T>& uv) {
    return cube(background_direction(b, uv), b.sky_level) * b.sky_intensity;
}

// picture(uv, level), of so many rows at the coarser level that is read.
template <class T, class Picture>
Vec3<T> background_of_picture(const Background<T>& b, const Picture& picture, const T& rows, const Vec2<T>& uv) {
    return sample_equirect(picture, background_direction(b, uv), b.sky_level, rows) * b.sky_intensity;
}

}  // namespace kiln::reference
