#version 450
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if PASS == 0
    color.x = 1.0;
#if FOG
    color.y = 1.0;
#endif
#endif
}
