#version 450
// A triangle that covers the screen: three vertices, no input.

layout(location = 0) out vec2 screen_uv;    // [0, 1] on the screen, v down

void main() {
    const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0;
    screen_uv = corner;
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
