#version 450
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
#if LIGHT_TYPE != 0 && CASCADES > 1
    color.x = float(CASCADES);
#elif LIGHT_TYPE
    color.x = -1.0;
#endif
#ifdef SKINNED
    color.y = 1.0;
#endif
#if SKINNED + TWO_SIDED == 2
    color.z = 1.0;
#endif
#if (LIGHTMAP & 6) != 0
    color.w = float(LIGHTMAP / 2);
#endif
#if BIAS < 0 || BIAS << 1 == 32
    color.z += 0.5;
#endif
}
