#include "x.glsl"
