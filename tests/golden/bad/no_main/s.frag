#version 450
#if A
void main() {}
#endif
