#version 450
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer B { float b[]; };
void main() {
    for (int i = 0; i < TAPS * SCALE; ++i) b[i] = 0.0;
}
