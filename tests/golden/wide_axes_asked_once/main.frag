#version 450
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if MATERIAL_ID == 7
    color.x = 1.0;
#endif
#if LIGHT_ID == 7
    color.y = 1.0;
#endif
#if DECAL_ID == 7
    color.z = 1.0;
#endif
}
