#version 450
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
    color.x = float(QUALITY);
#if MODE1 == 2
    color.y = 1.0;
#endif
#if F0
    color.x += 0.5;
#endif
}
