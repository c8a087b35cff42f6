#pragma once
// uber/lib compiled as C++ twice: `single` as a shader computes it, `twice` in double precision, from the same text.

#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wkeyword-macro"
#endif

#define xy swizzle_xy()
#define yx swizzle_yx()
#define zw swizzle_zw()
#define xyz swizzle_xyz()

#define KILN_SCALAR float
namespace single {
#include "tests/unit/uber/glsl_types.h"
#define float Real
#include "tests/unit/uber/library_files.h"
#undef float
}  // namespace single
#undef KILN_SCALAR

#undef KILN_MATH_GLSL
#undef KILN_VECTORS_GLSL
#undef KILN_OCTAHEDRAL_GLSL
#undef KILN_LIGHTS_GLSL
#undef KILN_FRESNEL_GLSL
#undef KILN_GGX_GLSL
#undef KILN_COOK_TORRANCE_GLSL
#undef KILN_BLINN_PHONG_GLSL
#undef KILN_SH_LIGHTMAP_GLSL
#undef KILN_SHADOW_MAP_GLSL
#undef KILN_MATERIALS_GLSL
#undef KILN_MOTION_GLSL

#define KILN_SCALAR double
namespace twice {
#include "tests/unit/uber/glsl_types.h"
#define float Real
#include "tests/unit/uber/library_files.h"
#undef float
}  // namespace twice
#undef KILN_SCALAR

#undef xy
#undef yx
#undef zw
#undef xyz

#pragma GCC diagnostic pop
