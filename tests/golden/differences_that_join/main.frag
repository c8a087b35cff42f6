#version 450
#if A
#define WIDTH 4
#else
#define WIDTH 8
#endif
#if B
#define UNREAD 1
#endif
#if C
#define PICK(x) (x)
#else
#define PICK(x) (x)
#endif
#if D
#define TEMPORARY 1
#endif
#undef TEMPORARY
layout(location = 0) out vec4 color;
void main() {
    color = vec4(0.0);
    color.x = float(WIDTH);
    color.y = PICK(2.0);
#ifdef TEMPORARY
    color.z = 1.0;
#endif
#if WIDTH == 4 && defined(UNREAD)
    color.w = 1.0;
#endif
}
