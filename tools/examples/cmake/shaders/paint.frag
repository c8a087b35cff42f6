#version 450
#include "lib/stripes.glsl"

layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;

void main() {
    vec3 c = vec3(0.8, 0.1, 0.2);
#if STRIPED
    c *= stripes(uv);
#endif
#if QUALITY == 1
    c = sqrt(c);
#endif
#if GLOW
    c += 0.25;
#endif
    color = vec4(c, 1.0);
}
