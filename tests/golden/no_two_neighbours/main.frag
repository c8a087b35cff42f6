#version 450
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if F0
    color.x += 0.5;
#endif
#if F1
    color.x += 1.5;
#endif
#if F58
    color.x += 2.5;
#endif
#if F59
    color.x += 3.5;
#endif
}
