#version 450
#include "common.glsl"
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if DERIVED0
    color.x = 1.0;
#endif
#if DERIVED2
    color.y = 1.0;
#endif
}
