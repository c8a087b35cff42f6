#include "y.glsl"
