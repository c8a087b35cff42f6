#version 450
layout(location = 0) in vec3 p;
void main() {
    gl_Position = vec4(p, 1.0);
#if GRASS
    gl_Position.x += 0.1;
#endif
}
