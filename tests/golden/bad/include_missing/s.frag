#version 450
#include "gone.glsl"
void main() {}
