#version 450
#if A && B
#error A and B do not go together
#endif
void main() {}
