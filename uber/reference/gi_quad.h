#pragma once
// Rectangles and lamps, as uber/lib/gi_quad.glsl names them.

#include "uber/reference/numbers.h"

namespace kiln::reference {

template <class T>
struct GiQuad {
    Vec3<T> origin, u, v, albedo, emission;
};

template <class T>
struct GiLamp {
    Vec3<T> position, axis, intensity;
};

}  // namespace kiln::reference
