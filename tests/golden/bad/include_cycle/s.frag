#version 450
#include "x.glsl"
void main() {}
