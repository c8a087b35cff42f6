#version 450
#ifndef LIGHT_TYPE
#define LIGHT_TYPE 0
#endif
#ifndef TINT
#define TINT 3
#endif
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if LIGHT_TYPE > 0
    color.x = 1.0;
#endif
    color.y = float(TINT);
}
